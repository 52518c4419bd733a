"""Runs the built `grouser` as a user does."""

import json
import os
import subprocess

COMMAND = os.environ["GROUSER_COMMAND"]
SOURCE_DIR = os.environ["GROUSER_SOURCE_DIR"]
DATA = os.path.join(SOURCE_DIR, "test_data")

# A fifth of a second: the whole path from scenario to files, not the drive.
SHORT_S = 0.2
SHORT_RUN = ["--set", f"duration_s={SHORT_S}"]

# What run.json says of the time that the machine took, the one part that differs from run to run.
CLOCK = ("wall_time_s", "assembly_wall_time_s", "real_time_factor")


def run(*arguments, cwd=None):
    """The completed process; raises with its stderr when it ends with another code than 0."""
    done = subprocess.run([COMMAND, *map(str, arguments)], cwd=cwd, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"grouser {' '.join(map(str, arguments))} ended with {done.returncode}:\n{done.stderr}")
    return done


def result(*arguments, cwd=None):
    """What --json prints."""
    return json.loads(run(*arguments, "--json", cwd=cwd).stdout)


def short_data(folder):
    """test_data whose runs are short."""
    for name in ("rig", "vehicles", "bushings"):
        os.symlink(os.path.join(DATA, name), os.path.join(folder, name))
    os.mkdir(os.path.join(folder, "scenarios"))
    for name in ("run_a.json", "run_b.json"):
        with open(os.path.join(DATA, "scenarios", name), encoding="utf-8") as file:
            scenario = json.load(file)
        scenario["duration_s"] = SHORT_S
        with open(os.path.join(folder, "scenarios", name), "w", encoding="utf-8") as file:
            json.dump(scenario, file)
    return folder


def children_of(process):
    """Of a process's first thread; none when it has ended."""
    try:
        with open(f"/proc/{process}/task/{process}/children", encoding="utf-8") as file:
            return [int(child) for child in file.read().split()]
    except (FileNotFoundError, ProcessLookupError):
        return []
