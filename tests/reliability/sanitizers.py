"""The suite as a preset builds it, and every report counted: sanitizers.py PRESET

   asan   AddressSanitizer and UndefinedBehaviorSanitizer
   tsan   ThreadSanitizer
   debug  an invalid operation, a division by zero or an overflow ends a program of numbers

The programs of tests that each form runs stand in sanitized.json: those that need no minutes, and in the long form all of them.
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
         "tsan": "The rasteriser, which is not instrumented, draws without threads here.",
         "debug": "Other programs have no traps: libraries for pictures trip over them by design."}
# They run the commands of README and demo at full length: what they call is called by others, too.
LEFT_OUT = "^(demo|readme)$"
WHOLE = "the whole suite but the parts of this page, the demo and README's commands"
# Kinds of planted_fault.cpp that must be noticed.
PLANTED = {"asan": ("overflow", "cast", "heap", "leak"), "tsan": ("race",), "debug": ("invalid",)}
# What GCC's UndefinedBehaviorSanitizer says beside AddressSanitizer, on stderr only. It ends the process with 1, an exit code that no
# command of this program has, so a test that does not show it fails.
UNDEFINED = re.compile("runtime error: ")


def build(preset, programs):
    targets = ["--target", *programs, "planted_fault"] if programs else []
    for command in (["cmake", "--preset", preset], ["cmake", "--build", "--preset", preset, *targets]):
        subprocess.run(command, cwd=SOURCE, check=True, stdout=sys.stderr)


class Watch:
    """Where sanitizers write, of every process: what a test's own process or a command that it runs says elsewhere may be lost."""

    def __init__(self, folder):
        self.folder = os.path.join(folder, "reports")
        os.mkdir(self.folder)
        told = f"log_path={self.folder}/report"
        self.environment = {**os.environ, "ASAN_OPTIONS": told, "TSAN_OPTIONS": told, "UBSAN_OPTIONS": f"print_stacktrace=1:{told}"}

    def take(self):
        """The reports since the last call."""
        texts = []
        for name in sorted(os.listdir(self.folder)):
            path = os.path.join(self.folder, name)
            with open(path, encoding="utf-8", errors="replace") as file:
                texts.append(file.read())
            os.remove(path)
        return texts


def planted(part, preset, watch):
    """Silence counts where a fault is told of, and ends the program that has it."""
    for kind in PLANTED[preset]:
        done = subprocess.run([os.path.join(SOURCE, "build", preset, "planted_fault"), kind], env=watch.environment, check=False,
                              capture_output=True, text=True)
        told = len(watch.take()) + len(UNDEFINED.findall(done.stderr))
        part.require(done.returncode != 0, f"a planted {kind} ended with 0")
        part.require(told == (preset != "debug"), f"a planted {kind} made {told} reports")
    part.row("faults planted: " + ", ".join(PLANTED[preset]), len(PLANTED[preset]), "each noticed")


def run_tests(preset, programs, folder, watch):
    """What ctest says of each."""
    found = os.path.join(folder, "found.xml")
    chosen = ["-L", f"^({'|'.join(programs)})$"] if programs else ["-E", LEFT_OUT]
    subprocess.run(["ctest", "--test-dir", os.path.join(SOURCE, "build", preset), *chosen, "--output-on-failure", "-j",
                    str(os.cpu_count()), "--output-junit", found, "--test-output-size-passed", "1000000",
                    "--test-output-size-failed", "1000000"], check=False, stdout=sys.stderr, env=watch.environment)
    return list(xml.etree.ElementTree.parse(found).getroot().iter("testcase"))


def work(part, thorough, preset):
    with open(os.path.join(HERE, "sanitized.json"), encoding="utf-8") as file:
        programs = json.load(file)["long" if thorough else "short"][preset]  # none for all
    build(preset, programs)
    with tempfile.TemporaryDirectory() as folder:
        watch = Watch(folder)
        planted(part, preset, watch)
        cases = run_tests(preset, programs, folder, watch)
        reports = watch.take() + [text for case in cases if UNDEFINED.search(text := case.findtext("system-out") or "")]
    for report in reports:
        print(report, file=sys.stderr, flush=True)
    skipped = [case for case in cases if case.get("status") == "notrun"]
    failed = [case.get("name") for case in cases if case.get("status") == "fail"]
    part.require(len(cases) > len(skipped), "no test ran")
    part.require(not failed, f"{', '.join(failed)} failed")
    part.require(not reports, f"{len(reports)} reports")
    part.row("tests of " + (", ".join(programs) or WHOLE), len(cases) - len(skipped),
             f"{len(failed)} failed, {len(reports)} reports" + (f"; {len(skipped)} more skipped" if skipped else ""))
    part.note(NOTES[preset])


if __name__ == "__main__":
    main("sanitizers", TITLES, work)
