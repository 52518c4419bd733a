"""Runs the built `grouser` as a user does."""

import json
import os
import subprocess

COMMAND = os.environ["GROUSER_COMMAND"]
SOURCE_DIR = os.environ["GROUSER_SOURCE_DIR"]
DATA = os.path.join(SOURCE_DIR, "test_data")

# A fifth of a second: the whole path from scenario to files, not the drive.
SHORT_RUN = ["--set", "duration_s=0.2"]


def run(*arguments, cwd=None):
    """The completed process; raises with its stderr when it ends with another code than 0."""
    done = subprocess.run([COMMAND, *map(str, arguments)], cwd=cwd, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"grouser {' '.join(map(str, arguments))} ended with {done.returncode}:\n{done.stderr}")
    return done


def result(*arguments, cwd=None):
    """What --json prints."""
    return json.loads(run(*arguments, "--json", cwd=cwd).stdout)
