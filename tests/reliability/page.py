#!/usr/bin/python3
"""docs/reliability.md, from what the parts measured.

   page.py DIR_OF_JSON docs/reliability.md    writes the page from the JSON files that `PART.py --thorough -o` left
   page.py --run BUILD_DIR                    runs every part in its long form first; their JSON goes to BUILD_DIR/reliability
"""

import argparse
import json
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.dirname(os.path.dirname(HERE))
PAGE = os.path.join(SOURCE, "docs", "reliability.md")
PARTS = ("inputs", "fuzz", "kills", "faults", "numerics", "hashes", "twice", "memory", "sanitizers asan", "sanitizers tsan",
         "sanitizers debug", "valgrind", "pages", "binary")
OPENING = """# Reliability

Written by `tests/reliability/page.py` from what its parts counted; every row was measured by a program that ends with an error at the
first loss, crash or difference. The suite runs each part in a short form; this page is of the long forms:

```sh
tests/reliability/page.py --run build/release
```

runs all of them and writes this page again, or none if one fails. It needs what `.ci/run` installs, and `valgrind`. One alone: the command
under its heading, with `GROUSER_SOURCE_DIR=$PWD GROUSER_COMMAND=$PWD/build/release/grouser` set. Below it stands which commit was measured.
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


def figures(folder, part):
    return os.path.join(folder, part.replace(" ", "_") + ".json")


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


def write(folder, page):
    sections = []
    for name in PARTS:
        if not os.path.exists(figures(folder, name)):
            sections.append(f"\n## {name}: not measured for this page\n\n{shown(name)}")
            continue
        with open(figures(folder, name), encoding="utf-8") as file:
            sections.append(section(json.load(file)))
    with open(page, "w", encoding="utf-8") as file:
        file.write(OPENING + "".join(sections) + mended())


def run_parts(build):
    """Every part, even behind one that failed; their figures' folder."""
    folder = os.path.join(build, "reliability")
    os.makedirs(folder, exist_ok=True)
    environment = dict(os.environ, GROUSER_SOURCE_DIR=SOURCE, GROUSER_COMMAND=os.path.join(build, "grouser"),
                       LP_NUM_THREADS="0", MESA_SHADER_CACHE_DISABLE="true")
    failed = []
    for name in PARTS:
        print(f"== {name}", file=sys.stderr, flush=True)
        if subprocess.run([sys.executable, *command(name), "-o", figures(folder, name)], env=environment).returncode != 0:
            failed.append(name)
    if failed:
        sys.exit("page.py: no page, for these parts failed: " + ", ".join(failed))
    return folder


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", metavar="BUILD_DIR", help="run every part in its long form first, with this build's program")
    parser.add_argument("folder", nargs="?", metavar="DIR_OF_JSON")
    parser.add_argument("page", nargs="?", default=PAGE)
    options = parser.parse_args()
    if (options.run is None) == (options.folder is None):
        parser.error("expected either --run BUILD_DIR or DIR_OF_JSON")
    write(run_parts(os.path.abspath(options.run)) if options.run else options.folder, options.page)


if __name__ == "__main__":
    main()
