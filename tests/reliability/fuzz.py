"""libFuzzer over the readers and the report writer, with AddressSanitizer and UndefinedBehaviorSanitizer.

Builds the preset `fuzz` (clang) and runs each program for a minute, or for GROUSER_FUZZ_SECONDS, two at a time: a core each. What it
finds stays beside the corpus of the build folder; an input that once went wrong belongs into tests/fuzz/corpus, where the ordinary
tests feed it too. The short form goes the same ways each time; the long form goes new ones.

A fault is whatever a sanitizer or libFuzzer reports, of the program or of a child of it, whoever survives it. Only HDF5, which is not
built with sanitizers, may crash on a damaged file, hang, and leak: grouser surveys each file in a process of its own for that reason.
"""

import concurrent.futures
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

from part import main

SOURCE = os.path.realpath(os.environ.get("GROUSER_SOURCE_DIR", os.path.join(os.path.dirname(__file__), "..", "..")))
BUILD = os.environ.get("GROUSER_FUZZ_BUILD", os.path.join(SOURCE, "build", "fuzz"))
SYMBOLIZER = "/usr/lib/llvm-14/bin/llvm-symbolizer"
JSON = ["-max_len=20000", "-timeout=60", "-dict=" + os.path.join(SOURCE, "tests", "fuzz", "json.dict")]
TARGETS = {
    "json": JSON,
    "csv": ["-max_len=4096", "-timeout=60"],
    "hdf5": ["-max_len=8192", "-timeout=10", "-detect_leaks=0"],  # leaks are told at the end, all together: HDF5 has many
    "report": JSON,
    "run_report": JSON,
}
# Programs with faults on purpose: where these are not found, that nothing was found elsewhere says nothing.
PLANTED = {"planted_overflow": "an overflow", "planted_child": "a read past the end, called by HDF5, in a child that nobody asks for"}
PLANTED_SECONDS = 5
# HDF5 asks for whatever size a file claims, and is refused; new that is refused is a fault. A small quarantine makes forks quick.
ENVIRONMENT = {"ASAN_OPTIONS": "detect_leaks=1:allocator_may_return_null=1:max_allocation_size_mb=256:quarantine_size_mb=16",
               "UBSAN_OPTIONS": "halt_on_error=1:print_stacktrace=1", "ASAN_SYMBOLIZER_PATH": SYMBOLIZER}

REPORT = re.compile(r"^(?=.*(?:runtime error:|ERROR: (?:\w+Sanitizer|libFuzzer)))", re.MULTILINE)
OURS = re.compile(re.escape(SOURCE) + r"/\S+\.(?:cpp|h):\d")
OUR_LOOPS = re.compile(r"fault_of_plain_chunks|unpacks_whole|survey_chunks")  # over what a file claims, and inside HDF5 most of the time
HDF5 = re.compile(r"/libhdf5\w*\.so")


def build():
    for command in (["cmake", "--preset", "fuzz", "-B", BUILD], ["cmake", "--build", BUILD, "--target", "fuzzers"]):
        subprocess.run(command, cwd=SOURCE, check=True, stdout=sys.stderr)


def is_of_hdf5(report):
    """Whether HDF5 alone is at fault: its frames lie inside all of ours, in the stack of the crash and in those of what leaked or was
    overrun (what lies next to a wild address says nothing), and it was at a survey, not at what a survey had let through."""
    if "libFuzzer: timeout" in report and OUR_LOOPS.search(report):
        return False
    stacks = [stack.splitlines() for stack in re.split(r"^\s+#0 ", report, flags=re.MULTILINE)[1:]]
    counted = stacks if "LeakSanitizer" in report or " 0 bytes to the right of " in report else stacks[:1]
    innermost = [next((line for line in stack if OURS.search(line) or HDF5.search(line)), "") for stack in counted]
    return bool(counted) and all(HDF5.search(line) for line in innermost) and "run_reader.cpp" not in report


def run_once(target, seconds, folder, seed):
    """Runs a fuzzer, with a seed of its choice for 0; its corpus grows in a folder of its own, the repository's is only read. Its log."""
    found, seeds = os.path.join(folder, target), os.path.join(SOURCE, "tests", "fuzz", "corpus", target)
    os.makedirs(os.path.join(found, "corpus"), exist_ok=True)
    command = [os.path.join(BUILD, f"fuzz_{target}"), f"-max_total_time={seconds}", f"-seed={seed}", "-rss_limit_mb=4096", "-print_final_stats=1",
               f"-artifact_prefix={found}/", *TARGETS.get(target, []), os.path.join(found, "corpus")]
    done = subprocess.run(command + [seeds] * os.path.isdir(seeds), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
                          env={**os.environ, "TMPDIR": folder, **ENVIRONMENT})
    log = done.stdout.decode(errors="replace")
    explained = done.returncode == 0 or done.returncode > 0 and REPORT.search(log)
    return log if explained else f"{log}\nERROR: libFuzzer ended with {done.returncode}\n"


def fuzz(target, seconds, folder, by_chance=False):
    """Runs a fuzzer until the time is over or a fault of ours is found; where HDF5 crashed it, anew. Its log, and the faults."""
    log, faults, end, seed = "", [], time.monotonic() + seconds, 0
    while not faults and (left := round(end - time.monotonic())) > 0:
        seed += not by_chance
        log += run_once(target, left, folder, seed)
        faults = [report for report in REPORT.split(log)[1:] if not is_of_hdf5(report)]
    if faults and target in TARGETS:
        shutil.copytree(os.path.join(folder, target), os.path.join(BUILD, f"found_{target}"), dirs_exist_ok=True)
    return log, faults


def add_row(part, target, seconds, log, faults):
    executed = sum(map(int, re.findall(r"^stat::number_of_executed_units:\s*(\d+)", log, re.MULTILINE)))
    covered = max(map(int, re.findall(r"cov: (\d+)", log)), default=0)
    part.require(executed > 0, f"fuzz_{target} executed nothing")
    for report in faults:
        part.require(False, f"fuzz_{target}, see {BUILD}/found_{target}:\n{report[:6000]}")
    crashes = len(REPORT.findall(log)) - len(faults)
    part.row(f"fuzz_{target}, {seconds} s", executed, f"{covered} edges covered, " +
             (f"{len(faults)} faults" if faults else "no crash, leak, undefined behaviour, hang, or more than 4 GB") +
             (f"; HDF5 itself failed {crashes} times" if crashes else ""))


def work(part, thorough):
    for tool, package in (("clang++-14", "clang-14 libclang-rt-14-dev"), (SYMBOLIZER, "llvm-14")):
        if shutil.which(tool) is None:
            sys.exit(f"fuzz: expected {tool} (Debian: {package}), found none")
    build()
    seconds = int(os.environ.get("GROUSER_FUZZ_SECONDS", "600" if thorough else "60"))
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as folder, \
            concurrent.futures.ThreadPoolExecutor(2) as pool:
        running = {target: pool.submit(fuzz, target, seconds, folder, thorough) for target in TARGETS}
        planted = {target: pool.submit(fuzz, target, PLANTED_SECONDS, folder) for target in PLANTED}
        for target, result in running.items():
            add_row(part, target, seconds, *result.result())
        found = [PLANTED[target] for target, result in planted.items() if result.result()[1]]
    part.require(len(found) == len(PLANTED), f"faults on purpose: expected {list(PLANTED.values())}, found {found}")
    part.row(f"faults on purpose, {PLANTED_SECONDS} s each", len(PLANTED), "found: " + "; ".join(found))


if __name__ == "__main__":
    main("fuzz", "Coverage-guided fuzzing under AddressSanitizer and UndefinedBehaviorSanitizer", work)
