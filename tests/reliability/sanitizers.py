"""The suite under AddressSanitizer with UndefinedBehaviorSanitizer, and under ThreadSanitizer: programs of tests built by the presets
asan and tsan, run by ctest, and every report counted. `.ci/run asan tsan` builds them."""

import json
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

sys.path.insert(0, os.path.join(os.environ["GROUSER_SOURCE_DIR"], "tests", "pipeline"))
from command import SOURCE_DIR  # noqa: E402
from part import main  # noqa: E402

PRESETS = {"asan": "AddressSanitizer and UndefinedBehaviorSanitizer", "tsan": "ThreadSanitizer"}
# Programs that need no minutes under a sanitizer, which .ci/run builds; the long form takes all that are built.
with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "sanitized.json"), encoding="utf-8") as list_file:
    FAST = json.load(list_file)
REPORT = re.compile(r"ERROR: (?:Address|Leak)Sanitizer|WARNING: ThreadSanitizer|runtime error: ")


def tested(part, preset, name, thorough):
    build = os.path.join(SOURCE_DIR, "build", preset)
    if not os.path.exists(os.path.join(build, "CTestTestfile.cmake")):
        part.require(not thorough, f"{build} is missing: .ci/run {preset} builds it")
        part.note(f"{name}: not built here; .ci/run {preset} does.")
        return
    with tempfile.TemporaryDirectory() as folder:
        found = os.path.join(folder, "found.xml")
        chosen = [] if thorough else ["-L", f"^({'|'.join(FAST[preset])})$"]
        subprocess.run(["ctest", "--test-dir", build, *chosen, "--output-junit", found, "--test-output-size-passed", "1000000",
                        "--test-output-size-failed", "1000000"], check=False, stdout=subprocess.DEVNULL,
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
    for preset, name in PRESETS.items():
        tested(part, preset, name, thorough)


if __name__ == "__main__":
    main("sanitizers", "Sanitizers", work)
