"""The suite under AddressSanitizer with UndefinedBehaviorSanitizer, and under ThreadSanitizer, and every report counted.

Builds the presets `asan` and `tsan` and runs programs of theirs that need no minutes (sanitized.json). The long form runs all programs,
and those of the preset `debug`, in which an invalid operation, a division by zero or an overflow ends a program of numbers.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

from part import main

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.dirname(os.path.dirname(HERE))
PRESETS = {"asan": "AddressSanitizer and UndefinedBehaviorSanitizer", "tsan": "ThreadSanitizer"}
LONG_PRESETS = {**PRESETS, "debug": "traps for floating-point exceptions (preset debug)"}
# Tests that set limits of memory and time for whole commands, and those that run the commands of README and demo at full length: what
# they call is called by others, too.
LEFT_OUT = "^(reliability_.*|demo|readme)$"
REPORT = re.compile(r"ERROR: (?:Address|Leak)Sanitizer|WARNING: ThreadSanitizer|runtime error: ")


def build(preset, programs):
    targets = ["--target", *programs] if programs else []
    for command in (["cmake", "--preset", preset], ["cmake", "--build", "--preset", preset, *targets]):
        subprocess.run(command, cwd=SOURCE, check=True, stdout=sys.stderr)


def tested(part, preset, name, programs):
    """`programs`: none for all."""
    build(preset, programs)
    with tempfile.TemporaryDirectory() as folder:
        found = os.path.join(folder, "found.xml")
        chosen = ["-L", f"^({'|'.join(programs)})$"] if programs else ["-E", LEFT_OUT]
        subprocess.run(["ctest", "--test-dir", os.path.join(SOURCE, "build", preset), *chosen, "--output-on-failure", "-j",
                        str(os.cpu_count()), "--output-junit", found, "--test-output-size-passed", "1000000",
                        "--test-output-size-failed", "1000000"], check=False, stdout=sys.stderr,
                       env={**os.environ, "UBSAN_OPTIONS": "print_stacktrace=1"})
        suite = xml.etree.ElementTree.parse(found).getroot()
    cases = [case for case in suite.iter("testcase") if case.get("status") != "notrun"]
    failed = [case.get("name") for case in cases if case.get("status") == "fail"]
    reports = sum(len(REPORT.findall(case.findtext("system-out") or "")) for case in cases)
    part.require(cases, f"{name}: no test ran")
    part.require(not failed, f"{name}: {', '.join(failed)} failed")
    part.require(reports == 0, f"{name}: {reports} reports")
    part.row(f"tests under {name}", len(cases), f"{len(failed)} failed, {reports} reports")


def work(part, thorough):
    with open(os.path.join(HERE, "sanitized.json"), encoding="utf-8") as file:
        fast = json.load(file)
    for preset, name in (LONG_PRESETS if thorough else PRESETS).items():
        tested(part, preset, name, [] if thorough else fast[preset])


if __name__ == "__main__":
    main("sanitizers", "The suite under sanitizers", work)
