"""What a run remembers from step to step, read out of its checkpoint (simulator/checkpoint.h), and a run that remembers all of it."""

import os
import struct

import numpy

from command import DATA

# Arguments of `simulate`: rubber with Maxwell branches and friction stops, gas springs, a driver who steers by torque, rough ground and a
# half round under the tracks.
RICH_RUN = [os.path.join(DATA, "scenarios/half_round_20kmh.json"), *(word for each in (
    "assembly.settle_time_s=2.6", "assembly.step_ms=0.2", "vehicle.left.track.pre_tension_kN=60",  # assembled quickly
    "terrain.profile={\"file\": \"../terrain/rms_course_2in.csv\", \"start_m\": -2}",
    "terrain.obstacles.0.position_m=3",
    "drive.left.time_s=[0, 1]", "drive.right.time_s=[0, 1]",
    "drive.right.target_speed_km_per_h=[0, 22]",
) for word in ("--set", each))]
FORMAT = b"grouser.checkpoint/2"
HISTORY = ("deflection", "stop", "branch", "anchor_x", "anchor_y", "anchor_z", "stretch_x", "stretch_y", "anchored")


class Parts:
    """The parts of a checkpoint, in the order in which they were written."""

    def __init__(self, payload):
        self.payload, self.at = payload, 0

    def take(self, form):
        values = struct.unpack_from("<" + form, self.payload, self.at)
        self.at += struct.calcsize("<" + form)
        return values

    def bytes(self):
        """Of a text."""
        return self.take(f"{self.take('Q')[0]}s")[0]

    def numbers(self, kind="f8"):
        """A list of its own length."""
        count = self.take("Q")[0]
        values = numpy.frombuffer(self.payload, kind, count, self.at)
        self.at += values.nbytes
        return values

    def state(self):
        time, *base = self.take("d13d")
        chassis = numpy.concatenate([base, self.numbers(), self.numbers()])
        links = numpy.concatenate([self.numbers() for _ in range(4)])
        driver = numpy.array(self.take("2d"))
        return {"time": time, "chassis": chassis, "links": links, "driver": driver, **{name: self.numbers() for name in HISTORY}}

    def acceleration(self):
        return numpy.concatenate([self.take("6d"), *(self.numbers() for _ in range(3)), self.take("2d")])


def memory_of(path):
    """Name -> numbers of a checkpoint: the state at its time, what the integrator keeps of the step before, rows of run.h5 by table;
    and all bytes but the wall times, which no two runs share."""
    with open(path, "rb") as file:
        head, payload = file.read().split(b"\n", 1)
    if not head.startswith(FORMAT + b" "):
        raise ValueError(f"{path}: expected {FORMAT.decode()}, found {head[:40]}")
    parts = Parts(payload)
    for _ in range(7):  # the program's version and six inputs
        parts.bytes()
    parts.state()  # as assembled
    parts.take("dd?2d4d3d")  # knobs, sides, how it stands
    assembled = payload[:parts.at]
    parts.take("2d")  # wall times
    run = payload[parts.at:]
    rows = parts.numbers("u8")
    now, before = parts.state(), parts.state()
    accelerations = {"acceleration": parts.acceleration(), "acceleration_before": parts.acceleration()}
    step, step_before = parts.take("dd")
    return {**now, "rows": rows, "time_before": before["time"], **accelerations, "step": step, "step_before": step_before,
            "all": assembled + run}


def time_of(path):
    """s of the run, of its last checkpoint; 0 without one."""
    return memory_of(path)["time"] if os.path.exists(path) else 0.0


def missing_memory(path):
    """What a checkpoint of RICH_RUN must hold and this one does not."""
    memory = memory_of(path)
    missing = [name for name in ("chassis", "links", "driver", "rows", *HISTORY) if not numpy.any(memory[name])]
    touching = memory["anchored"] == 1.0
    if numpy.ptp(memory["anchor_z"][touching]) < 0.01:
        missing.append("rough ground under the tracks")
    if memory["step_before"] <= 0.0 or abs(memory["time_before"] + memory["step_before"] - memory["time"]) > 1e-12:
        missing.append("the step before")
    if numpy.array_equal(memory["acceleration"], memory["acceleration_before"]):
        missing.append("the acceleration before")
    return missing
