"""The suite as a preset builds it, and every report counted: sanitizers.py PRESET

   asan   AddressSanitizer and UndefinedBehaviorSanitizer
   tsan   ThreadSanitizer
   debug  an invalid operation, a division by zero or an overflow ends a program of numbers

The programs of tests that each form runs stand in sanitized.json: those that need no minutes, and in the long form all of them. Under
ThreadSanitizer it is some of those that have threads (NOTES).
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
TITLES = {"asan": "Under AddressSanitizer and UndefinedBehaviorSanitizer", "tsan": "Under ThreadSanitizer",
          "debug": "With traps for floating-point exceptions"}
NOTES = {"asan": "What stands in `simulator/` is built without use-after-scope (docs/decisions.md); its tests and everything else have it.",
         "tsan": "The writer of files, fits and films have threads there. Left out, though they have threads, too: test_vehicle (vehicles side by side), "
                 "test_simulator and whole commands. The rasteriser, which is not instrumented, draws without threads here."}
# Tests that set limits of memory and time for whole commands, and those that run the commands of README and demo at full length: what
# they call is called by others, too.
LEFT_OUT = "^(reliability_.*|demo|readme)$"
WHOLE = "the whole suite but the parts of this page, the demo and README's commands"
REPORT = re.compile(r"ERROR: (?:Address|Leak)Sanitizer|WARNING: ThreadSanitizer|runtime error: ")


def build(preset, programs):
    targets = ["--target", *programs] if programs else []
    for command in (["cmake", "--preset", preset], ["cmake", "--build", "--preset", preset, *targets]):
        subprocess.run(command, cwd=SOURCE, check=True, stdout=sys.stderr)


def run_tests(preset, programs, folder):
    """What ctest says of each."""
    found = os.path.join(folder, "found.xml")
    chosen = ["-L", f"^({'|'.join(programs)})$"] if programs else ["-E", LEFT_OUT]
    subprocess.run(["ctest", "--test-dir", os.path.join(SOURCE, "build", preset), *chosen, "--output-on-failure", "-j",
                    str(os.cpu_count()), "--output-junit", found, "--test-output-size-passed", "1000000",
                    "--test-output-size-failed", "1000000"], check=False, stdout=sys.stderr,
                   env={**os.environ, "UBSAN_OPTIONS": "print_stacktrace=1"})
    return [case for case in xml.etree.ElementTree.parse(found).getroot().iter("testcase") if case.get("status") != "notrun"]


def work(part, thorough, preset):
    with open(os.path.join(HERE, "sanitized.json"), encoding="utf-8") as file:
        programs = json.load(file)["long" if thorough else "short"][preset]  # none for all
    build(preset, programs)
    with tempfile.TemporaryDirectory() as folder:
        cases = run_tests(preset, programs, folder)
    failed = [case.get("name") for case in cases if case.get("status") == "fail"]
    reports = sum(len(REPORT.findall(case.findtext("system-out") or "")) for case in cases)
    part.require(cases, "no test ran")
    part.require(not failed, f"{', '.join(failed)} failed")
    part.require(reports == 0, f"{reports} reports")
    part.row("tests of " + (", ".join(programs) or WHOLE), len(cases), f"{len(failed)} failed, {reports} reports")
    if preset in NOTES:
        part.note(NOTES[preset])


if __name__ == "__main__":
    main("sanitizers", TITLES, work)
