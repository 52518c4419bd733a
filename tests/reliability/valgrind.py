"""Every command of the pipeline under valgrind's memcheck: what is read before it was written, accesses outside, leaks, files left open.

Builds the preset `valgrind`, for valgrind knows no AVX-512 and takes minutes for what has fused multiplications. Runs are short, and the
track is laid as always. It has one form, of minutes.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile

from part import main

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.dirname(os.path.dirname(HERE))
DATA = os.path.join(SOURCE, "test_data")
BUILD = os.path.join(SOURCE, "build", "valgrind")
RIG, PROTOCOL = os.path.join(DATA, "rig/reference/rig.json"), os.path.join(DATA, "rig/protocol/rig.json")
RUN = os.path.join(DATA, "scenarios/run_b.json")
SMALL = ("--size", "160x90")
COMMANDS = (
    (0, "check", RIG, RUN, os.path.join(DATA, "vehicles/reference.json")),
    (3, "check", os.path.join(SOURCE, "README.md")),
    (0, "identify", RIG, "-o", "fit"),
    (0, "rig", PROTOCOL, "--bushing", "fit/bushing.json", "-o", "rig"),
    (0, "simulate", RUN, "--bushing", "fit/bushing.json", "-o", "run", "--set", "duration_s=0.03"),
    (0, "render", "run", "--film", "run/film.mp4", *SMALL, "--fps", "30"),
    (0, "render", "run", "--still", "0.02", *SMALL, "-o", "stills"),
    (0, "plot", "run", "--figure", "tension", "-o", "tension.png"),
    (0, "plot", "run", "--figure", "tension_map", "-o", "map.svg"),
    (0, "export", "run", "--format", "csv", "-o", "csv"),
    (0, "report", "fit", "rig", "run", "-o", "report.html"),
    (0, "report", "run", "--against", "csv/probes_sprocket_torque.csv", "-o", "against.html"),
)
ERRORS = re.compile(r"ERROR SUMMARY: (\d+) errors")
OPEN_FILE = re.compile(r"Open file descriptor \d+:[^\n]*\n==\d+==    at [^\n]*")  # what a parent left open has no place


def build():
    for command in (["cmake", "--preset", "valgrind"], ["cmake", "--build", "--preset", "valgrind"]):
        subprocess.run(command, cwd=SOURCE, check=True, stdout=sys.stderr)


def checked(part, folder, code, *arguments):
    """One command, with the processes that it starts."""
    logs = os.path.join(folder, "logs")
    os.mkdir(logs)
    valgrind = ["valgrind", "--trace-children=yes", "--leak-check=full", "--errors-for-leak-kinds=definite", "--track-fds=yes",
                f"--suppressions={os.path.join(HERE, 'valgrind.supp')}", "--num-callers=30", f"--log-file={logs}/%p"]
    environment = {**os.environ, "LP_NUM_THREADS": "0"}
    done = subprocess.run([*valgrind, os.path.join(BUILD, "grouser"), *arguments], cwd=folder, env=environment, capture_output=True,
                          text=True)
    text, processes = "", os.listdir(logs)
    for name in processes:
        with open(os.path.join(logs, name), encoding="utf-8", errors="replace") as file:
            text += file.read()
    shutil.rmtree(logs)
    summaries = ERRORS.findall(text)
    errors, left_open = sum(map(int, summaries)), OPEN_FILE.findall(text)
    what = "grouser " + " ".join(arguments)
    part.require(done.returncode == code, f"{what} ended with {done.returncode}, expected {code}:\n{done.stderr[-2000:]}")
    part.require(summaries, f"{what}: valgrind counted nothing")
    part.require(errors == 0, f"{what}: {errors} errors:\n{text[-12000:]}")
    part.require(not left_open, f"{what}: files left open:\n" + "\n".join(left_open))
    shown = " ".join(argument.replace(SOURCE + os.sep, "") for argument in arguments)
    part.row(f"`grouser {shown}`", len(processes), f"{errors} errors and lost blocks, {len(left_open)} files left open")


def work(part, _thorough):
    if shutil.which("valgrind") is None:
        sys.exit("valgrind: expected valgrind (Debian: valgrind), found none")
    build()
    folder = tempfile.mkdtemp(prefix="grouser_valgrind_")
    try:
        for command in COMMANDS:
            checked(part, folder, *command)
    finally:
        shutil.rmtree(folder)
    part.note("The count is of processes: a file of HDF5 is surveyed by one of its own.")


if __name__ == "__main__":
    main("valgrind", "The pipeline under valgrind", work)
