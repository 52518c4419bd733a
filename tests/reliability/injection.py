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
from checkpoint import RICH_RUN  # noqa: E402
from command import CLOCK, COMMAND, DATA, children_of, short_data  # noqa: E402, F401
from part import save  # noqa: E402

INTERPOSER = os.path.join(os.path.dirname(os.path.abspath(COMMAND)), "libgrouser_interposer.so")
SCENARIO = os.path.join(DATA, "scenarios/m113.json")
QUICK = ["--set", "assembly.settle_time_s=2.6"]
PICTURE = ["--size", "160x90"]
PATIENCE = 300.0  # s, for one command on a loaded machine
REFUSED = 3  # the exit code of --resume where there is nothing to resume


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


def raw(values):
    """The bytes of a dataset; those of texts are pointers."""
    return repr(values.tolist()).encode() if values.dtype == object else values.tobytes()


def digest_of_channels(path):
    """Of every dataset of run.h5: name, shape, type, bytes."""
    digest = hashlib.sha256()

    def add(name, item):
        if isinstance(item, h5py.Dataset):
            value = item[()]
            digest.update(f"{name} {item.shape} {item.dtype}".encode() + raw(value))

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


def digest_or_fault(path):
    try:
        return digest_of(path)
    except (OSError, ValueError) as error:
        return f"cannot be read: {error}"


def tree(folder, digest=digest_of):
    """Path -> digest of every file below."""
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            found[os.path.relpath(path, folder)] = digest(path)
    return found


def differing(one, two):
    """Paths that are not the same in two trees."""
    return [path for path in sorted(set(one) | set(two)) if one.get(path) != two.get(path)]


def not_begun_with(path, whole):
    """Datasets of a run.h5 that are not the first rows, or all, of those of a whole one."""
    wrong = []

    def compare(name, item):
        if not isinstance(item, h5py.Dataset):
            return
        rows = len(begun[name]) if name in begun else len(item) + 1
        if rows > len(item) or raw(begun[name][()]) != raw(item[:rows]):
            wrong.append(name)

    with open_channels(path) as begun, open_channels(whole) as file:
        file.visititems(compare)
    return wrong


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
        begun = time.monotonic()
        must(self.arguments, self.trial("new"))
        self.duration = time.monotonic() - begun
        self.new = tree(os.path.join(self.new_folder(), "out"))

    def old_folder(self):
        return os.path.join(self.home, "old")

    def new_folder(self):
        return os.path.join(self.home, "new")

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
        """Files as no moment of the command leaves them."""
        out = os.path.join(folder, "out")
        found = {path: digest for path, digest in tree(out, digest_or_fault).items() if not is_temporary(path)}
        if self.resumed:
            return self.torn_run(out, found)
        return self.neither(found, set(self.old) | set(self.new) | set(found))

    def neither(self, found, paths):
        return [f"{path} is neither the old one nor the new one: {found.get(path)}" for path in sorted(paths)
                if not is_temporary(path) and found.get(path) not in (self.old.get(path), self.new.get(path))]

    def torn_run(self, out, found):
        """A summary vouches for what stands beside it: the old one for the old run, the new one for the new run. While neither stands
        the run is in progress, and its channels are still the old ones or begin as the new ones."""
        says = found.get("run.json")
        for whole, which in ((self.old, "old"), (self.new, "new")):
            if says == whole.get("run.json"):
                return [f"{path} beside the {which} run.json is not the {which} one: {found.get(path)}"
                        for path in self.not_of(whole, found)]
        if not says or not says.startswith("{") or json.loads(says)["status"] != "stopped":
            return [f"run.json is neither the old one nor the new one nor that of a run in progress: {says}"]
        wrong = self.neither(found, (set(self.old) | set(self.new) | set(found)) - {"run.json", "run.h5", "checkpoint"})
        if found.get("run.h5") == self.old.get("run.h5"):
            return wrong + (["checkpoint without the channels of its run"] if "checkpoint" in found else [])
        try:
            names = not_begun_with(os.path.join(out, "run.h5"), os.path.join(self.new_folder(), "out", "run.h5"))
        except (OSError, ValueError) as error:
            return wrong + [f"run.h5 cannot be read: {error}"]
        return wrong + [f"{name} in run.h5 does not begin as the new one" for name in names]

    def not_of(self, whole, found):
        """Files that differ from those of a whole run. The first change of a new one takes the old checkpoint away."""
        return [path for path in differing(whole, found) if not is_temporary(path)
                and not (whole is self.old and path == "checkpoint" and path not in found)]

    def recover(self, folder):
        """Does what a user does next, and says what is wrong with the result. A run that is not begun, or the old one, is run anew;
        nothing else is, for that would cover a loss."""
        out = os.path.join(folder, "out")
        done = run([*self.arguments, "--resume"] if self.resumed else self.arguments, folder)
        if self.resumed and done.returncode == REFUSED:
            now = tree(out, digest_or_fault)
            if now == self.new:
                return []
            if "run.json" not in now or not self.not_of(self.old, now):
                done = run(self.arguments, folder)
        if done.returncode != 0:
            return [f"the next command ended with {done.returncode}: {done.stderr.strip()[-300:]}"]
        return [f"{path} differs afterwards" for path in differing(tree(out, digest_or_fault), self.new)]


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
    must(["simulate", SCENARIO, "-o", "run", *QUICK, "--set", "duration_s=0.2"], home)
    must(["simulate", SCENARIO, "-o", "other_run", *QUICK, "--set", "duration_s=0.1"], home)
    fit, drive, other_run = (os.path.join(home, name) for name in ("fit", "run", "other_run"))
    bushing = os.path.join(fit, "bushing.json")
    film = ["--film", "film.mp4", "-o", "out", *PICTURE, "--fps", "400"]  # two stretches
    simulate = ["simulate", *RICH_RUN, "-o", "out", "--set"]
    return [
        Stage("identify", ["identify", rig, "-o", "out"], ["identify", other, "-o", "out"]),
        Stage("rig", ["rig", rig, "--bushing", bushing, "-o", "out"]),
        Stage("simulate", [*simulate, "duration_s=1.1"]),  # one checkpoint on the way
        Stage("simulate again", [*simulate, "duration_s=1.1"], [*simulate, "duration_s=0.6"]),
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
    if output and not failures:
        save({"part": part, "title": title, "rows": rows, "notes": notes}, output)
    for row in rows:
        print(f"{row['count']:>6}  {row['what']}: {row['result']}")
    return 1 if failures else 0


def seeded(text):
    return random.Random(text)
