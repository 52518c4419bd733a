"""libFuzzer over the readers and the report writer, with AddressSanitizer and UndefinedBehaviorSanitizer.

Builds the preset `fuzz` (clang) and runs each program for a minute, or for GROUSER_FUZZ_SECONDS. What it finds stays beside
the corpus of the build folder; an input that once went wrong belongs into tests/fuzz/corpus, where the ordinary tests feed it too.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile

from part import main

SOURCE = os.environ.get("GROUSER_SOURCE_DIR", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
BUILD = os.environ.get("GROUSER_FUZZ_BUILD", os.path.join(SOURCE, "build", "fuzz"))
# A hang is what outlasts the limit of 10 s of the processor, and of ten times that by the clock, on the survey of an HDF5 file.
HANG = 120  # s
TARGETS = {"json": 20000, "csv": 4096, "hdf5": 32768, "report": 20000}  # longest input in bytes


def build():
    for command in (["cmake", "--preset", "fuzz", "-B", BUILD], ["cmake", "--build", BUILD, "--target", "fuzzers"]):
        subprocess.run(command, cwd=SOURCE, check=True, stdout=sys.stderr)


def start(target, seconds, folder):
    """One fuzzer; its corpus grows in a folder of its own, the repository's is only read."""
    found = os.path.join(folder, target)
    os.makedirs(os.path.join(found, "corpus"))
    seeds = os.path.join(SOURCE, "tests", "fuzz", "corpus", target)
    command = [os.path.join(BUILD, f"fuzz_{target}"), f"-max_total_time={seconds}", f"-max_len={TARGETS[target]}", f"-timeout={HANG}",
               "-rss_limit_mb=4096", "-print_final_stats=1", f"-artifact_prefix={found}/", os.path.join(found, "corpus"), seeds]
    if target in ("json", "report"):
        command.insert(1, "-dict=" + os.path.join(SOURCE, "tests", "fuzz", "json.dict"))
    log = open(os.path.join(found, "log"), "w", encoding="utf-8")
    environment = {**os.environ, "TMPDIR": folder, "ASAN_OPTIONS": "detect_leaks=1:allocator_may_return_null=0"}
    return subprocess.Popen(command, stdout=log, stderr=log, env=environment), log.name


def figures(log):
    """Executions, the last count of covered edges, the seconds that it ran, by its own words, and all of these."""
    with open(log, encoding="utf-8", errors="replace") as file:
        text = file.read()
    executed = re.search(r"stat::number_of_executed_units:\s*(\d+)", text)
    covered = re.search(r".*cov: (\d+)", text, re.DOTALL)
    lasted = re.search(r"^Done \d+ runs in (\d+) second", text, re.MULTILINE)
    return [int(found[1]) if found else 0 for found in (executed, covered, lasted)] + [text]


def work(part, thorough):
    if shutil.which("clang++-14") is None:
        sys.exit("fuzz: expected clang++-14 (Debian: clang-14 libclang-rt-14-dev), found none")
    build()
    seconds = int(os.environ.get("GROUSER_FUZZ_SECONDS", "600" if thorough else "60"))
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as folder:
        targets = list(TARGETS)
        for pair in (targets[:2], targets[2:]):  # two at a time: a core each
            running = {target: start(target, seconds, folder) for target in pair}
            for target, (process, log) in running.items():
                process.wait()
                executed, covered, lasted, text = figures(log)
                right = process.returncode == 0
                if not right:
                    kept = os.path.join(BUILD, f"found_{target}")
                    shutil.copytree(os.path.join(folder, target), kept, dirs_exist_ok=True)
                    part.require(False, f"fuzz_{target} ended with {process.returncode}, see {kept}:\n{text[-3000:]}")
                part.require(executed > 0, f"fuzz_{target} executed nothing")
                found = "no crash, leak, undefined behaviour, hang, or more than 4 GB" if right else f"ended with {process.returncode}"
                part.row(f"fuzz_{target}, {lasted} s", executed, f"{covered} edges covered, {found}")


if __name__ == "__main__":
    main("fuzz", "Coverage-guided fuzzing under AddressSanitizer and UndefinedBehaviorSanitizer", work)
