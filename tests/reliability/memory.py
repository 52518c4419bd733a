"""Memory of a long run: what the process holds at a quarter, at half and at nine tenths of it and at its end, and what its checkpoint
holds. The long form is an hour of driving."""

import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.environ["GROUSER_SOURCE_DIR"], "tests", "pipeline"))
from command import COMMAND, DATA  # noqa: E402
from part import main  # noqa: E402

SETTLE = ["assembly.settle_time_s=3"]
# Name -> scenario, what is set besides the duration, the tables of the drive's times and speeds, most growth [B a simulated second].
DRIVES = {
    "11 km/h, sparse output": ("run_a", ["output.rate_Hz=1", "output.probe_rate_Hz=10"], ("[0, 10, {0}, {1}]", "[0, 10, 10, 0]"), 1400),
    "parked, full output": ("parked", [], None, 6000),
}
# B from a quarter to nine tenths: pages that the allocator and the libraries come to touch, and for each simulated second HDF5's index,
# some 60 B a chunk: measured 1.1 kB a second of sparse output over an hour, 4.0 kB of full output over ten minutes.
TOUCHED = 256 << 10
# B more after the last step: the run's figures and its last words in run.h5 touch code and buffers of their own, measured 4.5 MB.
ENDING = 8 << 20


def memory_of(process):
    """Resident set [B]; None once it has ended."""
    with open(f"/proc/{process.pid}/status", encoding="utf-8") as file:
        for line in file:
            if line.startswith("VmRSS:"):
                return int(line.split()[1]) << 10
    return None


def size_of(path):
    return os.path.getsize(path) if os.path.exists(path) else 0


def follow(process, folder):
    """(resident set, size of the checkpoint) from the first checkpoint to the end."""
    seen = []
    while process.poll() is None:
        checkpoint = size_of(os.path.join(folder, "checkpoint"))
        memory = memory_of(process)
        if checkpoint and memory:
            seen.append((memory, checkpoint))
        time.sleep(0.05)
    return seen


def drive(part, name, duration):
    scenario, sets, table, growth_a_second = DRIVES[name]
    sets = [*sets, *SETTLE, f"duration_s={duration}"]
    if table:
        times, speeds = table
        for side in ("left", "right"):
            sets += [f"drive.{side}.time_s={times.format(duration - 10, duration)}", f"drive.{side}.speed_rad_per_s={speeds}"]
    with tempfile.TemporaryDirectory() as folder:
        process = subprocess.Popen([COMMAND, "simulate", os.path.join(DATA, "scenarios", scenario + ".json"), "-o", "run", "--quiet",
                                    *(word for each in sets for word in ("--set", each))],
                                   cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        seen = follow(process, os.path.join(folder, "run"))
        part.require(process.returncode == 0, f"{name}: ended with {process.returncode}: {process.stderr.read()}")
        part.require(len(seen) >= 8, f"{name}: looked at {len(seen)} times only")
        quarter, half, late, last = (seen[int(share * (len(seen) - 1))] for share in (0.25, 0.5, 0.9, 1))
        most = TOUCHED + growth_a_second * 0.65 * duration
        part.require(late[0] - quarter[0] < most,
                     f"{name}: expected less than {most:.0f} B of growth from a quarter to nine tenths, found {late[0] - quarter[0]} B")
        most = ENDING + growth_a_second * 0.1 * duration
        part.require(last[0] - late[0] < most, f"{name}: expected less than {most:.0f} B more at the end, found {last[0] - late[0]} B")
        part.require(last[1] - quarter[1] < 1 << 18, f"{name}: its checkpoint grew from {quarter[1]} to {last[1]} B")
        part.row(f"{duration} s, {name}", len(seen),
                 "resident MB at a quarter, half, nine tenths, the end: " +
                 ", ".join(f"{memory / 1e6:.2f}" for memory, _ in (quarter, half, late, last)) +
                 f"; checkpoint {last[1] / 1e6:.2f} MB, run.h5 {size_of(os.path.join(folder, 'run/run.h5')) / 1e6:.0f} MB")


def work(part, thorough):
    if thorough:
        drive(part, "11 km/h, sparse output", 3600)
        drive(part, "parked, full output", 600)
    else:
        drive(part, "11 km/h, sparse output", 30)
    part.note("A step takes nothing from the heap: Memory.AStepOfDoublePinsTakesNothingFromTheHeap and Vehicle.AStepTakesNothingFromTheHeap "
              "(tests/simulator) count the calls.")


if __name__ == "__main__":
    main("memory", "Memory of a long run", work)
