#!/usr/bin/python3
"""docs/reliability.md, from what the parts measured: measured/PART.json beside this file.

   page.py                        writes the page
   page.py --check                fails where the page is not what would be written
   page.py --run BUILD_DIR [PART ...]
                                  runs these parts, or all, in their long form with this build's program, keeps what they measured, and
                                  writes the page
"""

import argparse
import json
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.dirname(os.path.dirname(HERE))
PAGE = os.path.join(SOURCE, "docs", "reliability.md")
MEASURED = os.path.join(HERE, "measured")
PARTS = ("inputs", "fuzz", "kills", "faults", "numerics", "hashes", "twice", "memory", "sanitizers asan", "sanitizers tsan",
         "sanitizers debug", "valgrind", "pages", "binary")
OPENING = """# Reliability

Written by `tests/reliability/page.py` from what its parts counted; every row was measured by a program that ends with an error at the
first loss, crash or difference. The suite runs each part in a short form; this page is of the long forms:

```sh
tests/reliability/page.py --run build/release
```

runs all of them, three hours on two cores, keeps what they measured in `tests/reliability/measured/` and writes this page again, or none
if one fails. Names of parts behind it run those alone: "kills", "sanitizers asan". It needs what `.ci/run` installs, and `valgrind`.
Under each heading stands the part's command, which takes `GROUSER_SOURCE_DIR=$PWD GROUSER_COMMAND=$PWD/build/release/grouser`, and
of which commit its figures are.
"""


def cell(text):
    """Text that stays inside its cell of a table."""
    return str(text).replace("|", "\\|").replace("\n", " ").replace("<", "&lt;")


def number(count):
    return f"{count:,}".replace(",", " ") if isinstance(count, int) else cell(count)


def command(part):
    """Of a part's long form: "sanitizers asan" is sanitizers.py with asan."""
    program, *choice = part.split()
    return [os.path.join(HERE, program + ".py"), *choice, "--thorough"]


def figures(part):
    return os.path.join(MEASURED, part.replace(" ", "_") + ".json")


def shown(part):
    return "`python3 " + " ".join(command(part)).replace(SOURCE + os.sep, "") + "`\n"


def section(part):
    lines = [f"\n## {part['title']}\n", shown(part["part"])]
    lines.append("Measured on {on} at {at}, {cores} cores, in {minutes:g} min.\n".format(**part["measured"]))
    if part["rows"]:
        lines += ["| what | count | result |", "| --- | ---: | --- |"]
        lines += [f"| {cell(row['what'])} | {number(row['count'])} | {cell(row['result'])} |" for row in part["rows"]]
    for note in part["notes"]:
        lines.append(f"\n{note}")
    return "\n".join(lines) + "\n"


def mended():
    """What was found before it was mended, with its mechanism: mended.json beside this file."""
    with open(os.path.join(HERE, "mended.json"), encoding="utf-8") as file:
        faults = json.load(file)
    lines = [f"\n## Found and mended\n\n{len(faults)} faults that these parts, or reviews of what they test, found, each with its mechanism.\n",
             "| found by | what happened | mechanism |", "| --- | --- | --- |"]
    lines += [f"| {cell(fault['found_by'])} | {cell(fault['what'])} | {cell(fault['mechanism'])} |" for fault in faults]
    return "\n".join(lines) + "\n"


def page():
    sections = []
    for name in PARTS:
        if not os.path.exists(figures(name)):
            sections.append(f"\n## {name}: not measured yet\n\n{shown(name)}")
            continue
        with open(figures(name), encoding="utf-8") as file:
            sections.append(section(json.load(file)))
    return OPENING + "".join(sections) + mended()


def run(parts, build):
    """Every one of them, even behind one that failed."""
    os.makedirs(MEASURED, exist_ok=True)
    environment = dict(os.environ, GROUSER_SOURCE_DIR=SOURCE, GROUSER_COMMAND=os.path.join(build, "grouser"),
                       LP_NUM_THREADS="0", MESA_SHADER_CACHE_DISABLE="true")
    failed = []
    for name in parts:
        print(f"== {name}", file=sys.stderr, flush=True)
        if subprocess.run([sys.executable, *command(name), "-o", figures(name)], env=environment, check=False).returncode != 0:
            failed.append(name)
    if failed:
        sys.exit("page.py: the page stays as it is, for these parts failed: " + ", ".join(failed))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", metavar="BUILD_DIR", help="run parts in their long form first, with this build's program")
    parser.add_argument("--check", action="store_true", help="compare only")
    parser.add_argument("parts", nargs="*", metavar="PART", help="of: " + ", ".join(PARTS))
    options = parser.parse_args()
    if unknown := [name for name in options.parts if name not in PARTS]:
        parser.error(f"no such part: {', '.join(unknown)}; expected of: {', '.join(PARTS)}")
    if options.parts and options.run is None:
        parser.error("parts are named behind --run BUILD_DIR")
    if options.run is not None:
        run(options.parts or PARTS, os.path.abspath(options.run))
    if options.check:
        with open(PAGE, encoding="utf-8") as file:
            if file.read() != page():
                sys.exit("docs/reliability.md is not what tests/reliability/page.py writes: run it")
        return
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(page())


if __name__ == "__main__":
    main()
