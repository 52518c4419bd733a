"""`grouser` with a fault injected by interposer.c, and short stages of the pipeline to inject it into."""

import ctypes
import hashlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import time

import h5py

sys.path.insert(0, os.path.join(os.environ["GROUSER_SOURCE_DIR"], "tests", "pipeline"))
from command import CLOCK, COMMAND, DATA, children_of, short_data  # noqa: E402, F401

INTERPOSER = os.path.join(os.path.dirname(os.path.abspath(COMMAND)), "libgrouser_interposer.so")
SCENARIO = os.path.join(DATA, "scenarios/m113.json")
RUN = ["--set", "duration_s=1.1", "--set", "assembly.settle_time_s=2.6"]  # one checkpoint on the way, a quick settling
PICTURE = ["--size", "160x90"]
PATIENCE = 300.0  # s, for one command on a loaded machine


def environment(under=None, calls="", at=0, do="", log=None, clock=False, gl=True):
    """What makes the interposer inject a fault (see there)."""
    if not os.path.exists(INTERPOSER):
        raise FileNotFoundError(f"{INTERPOSER}: expected the library built of interposer.c beside the program")
    faulty = dict(os.environ, LD_PRELOAD=INTERPOSER, GROUSER_FAULT_CALLS=calls, GROUSER_FAULT_DO=str(do),
                  ASAN_OPTIONS="verify_asan_link_order=0")
    if under:
        faulty["GROUSER_FAULT_UNDER"] = under
    if at:
        faulty["GROUSER_FAULT_AT"] = str(at)
    if log:
        faulty["GROUSER_FAULT_LOG"] = log
    if clock:
        faulty["GROUSER_FAULT_CLOCK"] = "1"
    if not gl:
        faulty["GROUSER_FAULT_GL"] = "1"
    return faulty


def start(arguments, cwd, env=None, **more):
    options = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, **more}
    return subprocess.Popen([COMMAND, *map(str, arguments)], cwd=cwd, env=env, **options)


def run(arguments, cwd, env=None):
    """The completed process, whatever it ended with."""
    return subprocess.run([COMMAND, *map(str, arguments)], cwd=cwd, env=env, capture_output=True, text=True,
                          timeout=PATIENCE, errors="replace")


def must(arguments, cwd):
    done = run(arguments, cwd)
    if done.returncode != 0:
        raise AssertionError(f"grouser {' '.join(map(str, arguments))} ended with {done.returncode}:\n{done.stderr}")
    return done


def read(path):
    with open(path, "rb") as file:
        return file.read()


def open_channels(path):
    """As a file with a writer: what a kill amid a flush leaves is read in this mode only. A damaged block is read 20 times; by
    itself HDF5 tries a hundred times and waits twice as long each time, for ever."""
    with open("/proc/self/maps", encoding="utf-8") as maps:
        library = ctypes.CDLL(next(line.split()[-1] for line in maps if re.search(r"/libhdf5(_serial)?\.so", line)))
    access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    library.H5Pset_metadata_read_attempts(ctypes.c_int64(access.id), ctypes.c_uint(20))
    flags = h5py.h5f.ACC_RDONLY | h5py.h5f.ACC_SWMR_READ
    return h5py.File(h5py.h5f.open(os.fsencode(path), flags, access))


def digest_of_channels(path):
    """Of every dataset of run.h5: name, shape, type, bytes."""
    digest = hashlib.sha256()

    def add(name, item):
        if isinstance(item, h5py.Dataset):
            value = item[()]
            digest.update(f"{name} {item.shape} {item.dtype}".encode())
            digest.update(repr(value.tolist()).encode() if value.dtype == object else value.tobytes())

    with open_channels(path) as file:
        file.visititems(add)
    return digest.hexdigest()


def digest_of(path):
    """Of what a file says, wall times apart."""
    name = os.path.basename(path)
    if name == "run.h5":
        return digest_of_channels(path)
    if name == "checkpoint":
        return "checkpoint"  # holds wall times; what it is worth, a resumed run shows
    if name == "run.json":
        content = json.loads(read(path))
        return json.dumps({key: value for key, value in content.items() if key not in CLOCK})
    return hashlib.sha256(read(path)).hexdigest()


def tree(folder):
    """Path -> digest of every file below."""
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            found[os.path.relpath(path, folder)] = digest_of(path)
    return found


def is_temporary(path):
    """What may lie beside the results of a killed command until the next one: files in the making and marks."""
    parts = path.split(os.sep)
    return any(part.endswith(".part") or part.startswith(".") for part in parts)


class Stage:
    """A command that writes into `out` of its folder, over the results of an earlier one."""

    def __init__(self, name, arguments, earlier=None):
        self.name = name
        self.arguments = arguments
        self.earlier = earlier  # arguments of the earlier command
        self.resumed = name.startswith("simulate")
        self.home = None

    def prepare(self, home):
        """Makes the old and the new results, each once; counts and times the calls."""
        self.home = os.path.join(home, self.name.replace(" ", "_"))
        os.makedirs(self.old_folder())
        if self.earlier:
            must(self.earlier, self.old_folder())
        self.old = tree(os.path.join(self.old_folder(), "out"))
        done = self.trial("new")
        begun = time.monotonic()
        must(self.arguments, done)
        self.duration = time.monotonic() - begun
        self.new = tree(os.path.join(done, "out"))

    def old_folder(self):
        return os.path.join(self.home, "old")

    def trial(self, name):
        """A fresh copy of what stood there before the command."""
        folder = os.path.join(self.home, name)
        shutil.copytree(self.old_folder(), folder, symlinks=True)
        return folder

    def count_calls(self, calls):
        """What the command does on its files, a line a call, in the order in which it does it."""
        folder = self.trial("counted")
        log = os.path.join(self.home, "calls")
        done = run(self.arguments, folder, environment(under=folder, calls=calls, log=log))
        if done.returncode != 0:
            raise AssertionError(f"{self.name} ended with {done.returncode} under the interposer:\n{done.stderr}")
        shutil.rmtree(folder)
        lines = read(log).decode().splitlines() if os.path.exists(log) else []
        if os.path.exists(log):
            os.remove(log)
        return lines

    def torn(self, folder):
        """Files that are neither the old nor the new ones."""
        out = os.path.join(folder, "out")
        found, wrong = {}, []
        for root, _, names in os.walk(out):
            for name in names:
                path = os.path.relpath(os.path.join(root, name), out)
                if is_temporary(path):
                    continue
                try:
                    found[path] = digest_of(os.path.join(root, name))
                except (OSError, ValueError) as error:
                    wrong.append(f"{path} cannot be read: {error}")
        for path in set(self.old) | set(self.new):
            if is_temporary(path) or path in {line.split(" ")[0] for line in wrong}:
                continue
            if self.resumed and path in ("run.h5", "run.json", "checkpoint"):
                wrong += self.torn_run(out) if path == "run.json" else []
                continue
            if found.get(path) not in (self.old.get(path), self.new.get(path)):
                wrong.append(f"{path} is neither the old one nor the new one")
        wrong += [f"{path} is litter" for path in found
                  if path not in self.old and path not in self.new and not self.resumed]
        return wrong

    def torn_run(self, out):
        """A run's summary is the old one, the new one, or says that the run is not finished; its channels can be read."""
        if not os.path.exists(os.path.join(out, "run.json")):
            return []
        says = digest_of(os.path.join(out, "run.json"))
        if says not in (self.old.get("run.json"), self.new.get("run.json")) and json.loads(says)["status"] != "stopped":
            return ["run.json is neither the old one nor the new one nor that of a run in progress"]
        return []

    def recover(self, folder):
        """Does what a user does next, and says what is wrong with the result."""
        out, wrong = os.path.join(folder, "out"), []
        if self.resumed and "--resume" not in self.arguments:
            done = run([*self.arguments, "--resume"], folder)
            ended = "expected a run that was stopped or killed" in done.stderr
            if done.returncode == 3 and (ended or not os.path.exists(os.path.join(out, "run.json"))):
                if tree(out) != self.new:  # the old run still stands, or none
                    done = run(self.arguments, folder)
                else:
                    return wrong
        else:
            done = run(self.arguments, folder)
            if self.resumed and done.returncode == 3 and "found completed" in done.stderr:
                done.returncode = 0
        if done.returncode != 0:
            return [f"the next command ended with {done.returncode}: {done.stderr.strip()[-300:]}"]
        now = tree(out)
        wrong += [f"{path} differs afterwards" for path in sorted(set(now) | set(self.new))
                  if now.get(path) != self.new.get(path)]
        return wrong


def write_rig(folder, axes):
    """A quarter of the reference campaign."""
    source = os.path.join(DATA, "rig/reference")
    with open(os.path.join(source, "rig.json"), encoding="utf-8") as file:
        rig = json.load(file)
    rig["tests"] = [test for test in rig["tests"] if test["axis"] in axes]
    os.makedirs(folder)
    for test in rig["tests"]:
        os.makedirs(os.path.dirname(os.path.join(folder, test["file"])), exist_ok=True)
        shutil.copy(os.path.join(source, test["file"]), os.path.join(folder, test["file"]))
    path = os.path.join(folder, "rig.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(rig, file)
    return path


def stages(home):
    """The pipeline, short; its inputs are made in `home`."""
    rig, other = write_rig(os.path.join(home, "rig"), "y"), write_rig(os.path.join(home, "other_rig"), "z")
    must(["identify", rig, "-o", "fit"], home)
    must(["simulate", SCENARIO, "-o", "run", *RUN, "--set", "duration_s=0.2"], home)
    must(["simulate", SCENARIO, "-o", "other_run", *RUN, "--set", "duration_s=0.1"], home)
    fit, drive, other_run = (os.path.join(home, name) for name in ("fit", "run", "other_run"))
    bushing = os.path.join(fit, "bushing.json")
    film = ["--film", "film.mp4", "-o", "out", *PICTURE, "--fps", "400"]  # two stretches
    simulate = ["simulate", SCENARIO, "-o", "out", *RUN]
    return [
        Stage("identify", ["identify", rig, "-o", "out"], ["identify", other, "-o", "out"]),
        Stage("rig", ["rig", rig, "--bushing", bushing, "-o", "out"]),
        Stage("simulate", simulate),
        Stage("simulate again", simulate, ["simulate", SCENARIO, "-o", "out", *RUN, "--set", "duration_s=0.3"]),
        Stage("render stills", ["render", drive, "--still", "0.1", "--still", "0.2", "-o", "out", *PICTURE],
              ["render", drive, "--still", "0.1", "-o", "out", *PICTURE, "--camera", "top"]),
        Stage("render frames", ["render", drive, "--frames", "-o", "out", *PICTURE, "--fps", "40"],
              ["render", drive, "--frames", "-o", "out", *PICTURE, "--fps", "60", "--camera", "top"]),
        Stage("render film", ["render", drive, *film], ["render", drive, *film, "--camera", "top"]),
        Stage("plot", ["plot", drive, "--figure", "tension", "-o", "out/tension.png"],
              ["plot", other_run, "--figure", "tension", "-o", "out/tension.png"]),
        Stage("report", ["report", fit, drive, "-o", "out/report.html"], ["report", fit, "-o", "out/report.html"]),
        Stage("export", ["export", drive, "-o", "out"], ["export", other_run, "-o", "out"]),
    ]


def spread(count, most, chance):
    """Numbers from 1 to `count`: all of them, or `most` of them with both ends."""
    if count <= most:
        return list(range(1, count + 1))
    if most < 3:
        return sorted(chance.sample(range(1, count + 1), most))
    return sorted({1, count, *chance.sample(range(2, count), most - 2)})


def told(failures):
    """Prints them when they are found, for the whole may take long."""
    for failure in failures:
        print("FAILED", failure, file=sys.stderr, flush=True)
    return failures


def finish(part, title, rows, notes, failures, output):
    """Writes the part's figures, prints them, and gives the exit code."""
    if output:
        with open(output, "w", encoding="utf-8") as file:
            json.dump({"part": part, "title": title, "rows": rows, "notes": notes}, file, indent=1)
    for row in rows:
        print(f"{row['count']:>6}  {row['what']}: {row['result']}")
    return 1 if failures else 0


def seeded(text):
    return random.Random(text)
