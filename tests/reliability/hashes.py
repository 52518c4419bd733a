"""SHA-256 of every dataset and file that a command writes: the same for repeated runs, for any number of threads, with more or
less output, stopped and resumed, and whatever the user's surroundings are."""

import contextlib
import hashlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile

import h5py

sys.path.insert(0, os.path.join(os.environ["GROUSER_SOURCE_DIR"], "tests", "pipeline"))
from checkpoint import RICH_RUN, missing_memory, time_of  # noqa: E402
from command import CLOCK, COMMAND, DATA  # noqa: E402
from part import main  # noqa: E402

SEED = 20261122
QUICK = ["--set", "assembly.settle_time_s=2.6"]
SCENARIO = os.path.join(DATA, "scenarios/m113.json")
RIG = os.path.join(DATA, "rig/reference/rig.json")
THREADS = (1, 2, 4)
INTERRUPTED = 130  # the exit code behind Ctrl-C


def digest(data):
    return hashlib.sha256(data).hexdigest()


def digest_of(values):
    """Of a dataset or a row of it: shape, type and bytes; those of texts are pointers."""
    raw = repr(values.tolist()).encode() if values.dtype == object else values.tobytes()
    return digest(repr((values.shape, str(values.dtype))).encode() + raw)


def hashes_of_run(folder):
    """Name -> SHA-256 of every dataset of run.h5, of the file as a whole, and of run.json without what a clock measured."""
    found = {}

    def keep(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = digest_of(item[()])

    with h5py.File(os.path.join(folder, "run.h5"), "r") as file:
        file.visititems(keep)
    with open(os.path.join(folder, "run.h5"), "rb") as file:
        found["run.h5"] = digest(file.read())
    with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
        summary = {key: value for key, value in json.load(file).items() if key not in CLOCK}
    found["run.json"] = digest(json.dumps(summary).encode())
    return found


def hashes_of_files(folder):
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, folder)] = digest(file.read())
    return found


class Bench:
    """Runs commands in folders of their own and compares what they leave."""

    def __init__(self, part, folder):
        self.part, self.folder, self.compared, self.number = part, folder, 0, 0

    def place(self, name="here"):
        self.number += 1
        place = os.path.join(self.folder, str(self.number), name)
        os.makedirs(place)
        return place

    def run(self, place, *arguments, before=(), **surroundings):
        done = subprocess.run([*before, COMMAND, *arguments, "--quiet"], cwd=place, capture_output=True, text=True,
                              env={**os.environ, **surroundings.pop("env", {})}, check=False, **surroundings)
        if done.returncode != 0:
            raise AssertionError(f"{' '.join(arguments)} ended with {done.returncode}: {done.stderr}")

    def same(self, what, expected, found, only=None):
        names = set(expected) | set(found) if only is None else set(only)
        differing = sorted(name for name in names if expected.get(name) != found.get(name))
        self.part.require(not differing, f"{what}: {', '.join(differing)} differ")
        self.part.require(names, f"{what}: nothing was compared")
        self.compared += len(names)

    def row(self, what):
        """Ends a table row: the hashes compared since the last one."""
        self.part.row(what, self.compared, "all equal" if not self.part.failures else "DIFFER")
        self.compared = 0


def drive(seconds):
    return ["simulate", SCENARIO, "-o", "run", "--set", f"duration_s={seconds}", *QUICK]


def rich_drive(seconds):
    return ["simulate", *RICH_RUN, "-o", "run", "--set", f"duration_s={seconds}"]


def simulated(bench, arguments, hashes=hashes_of_run, **options):
    place = bench.place(options.pop("name", "here"))
    bench.run(place, *arguments, **options)
    return hashes(os.path.join(place, "run"))


@contextlib.contextmanager
def locales(folder):
    """Locales with a decimal comma and with a dotless i, made here; none where the system has no sources of locales."""
    made = {}
    for name in ("de_DE", "tr_TR"):
        done = subprocess.run(["localedef", "-i", name, "-f", "UTF-8", os.path.join(folder, name + ".UTF-8")],
                              capture_output=True, check=False) if shutil.which("localedef") else None
        if done is not None and os.path.exists(os.path.join(folder, name + ".UTF-8", "LC_NUMERIC")):
            made[name] = {"LOCPATH": folder, "LC_ALL": name + ".UTF-8", "LANG": name + ".UTF-8"}
    yield made


def surroundings(bench, whole, arguments, thorough):
    """What a user's machine may differ in."""
    with locales(bench.place("locales")) as made:
        cases = {f"LC_ALL={name}": {"env": env} for name, env in made.items()}
        if not made:
            bench.part.note("No sources of locales on this system: other locales are not tried.")
        if thorough:
            cases["TZ"] = {"env": {"TZ": "Asia/Kathmandu"}}
            cases["umask 077"] = {"umask": 0o077}
            cases["no address-space randomisation"] = {"before": ("setarch", "-R")}
            cases["a folder with a blank and an umlaut"] = {"name": "zweiter Läuf"}
            cases["a small environment"] = {"before": ("env", "-i", "PATH=/usr/bin:/bin")}
        for name, options in cases.items():
            bench.same(f"simulate with {name}", whole, simulated(bench, arguments, **options))
    bench.row("simulate: " + ", ".join(cases))


def hashes_of_end(folder):
    """Name -> SHA-256 of what every output of a run has of its course: the step log, sums over all steps, and the last sample of all
    bodies, where one falls on the end."""
    found = {}
    with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
        summary = json.load(file)
    sums = {key: value for key, value in summary["results"].items() if key.startswith(("bushing_", "largest_", "least_"))}
    for name, value in {**sums, "steps": summary["steps"], "energy": summary["energy"]}.items():
        found[f"run.json {name}"] = digest(json.dumps(value).encode())
    with h5py.File(os.path.join(folder, "run.h5"), "r") as file:
        for name, item in file["steps"].items():
            found[f"steps/{name}"] = digest_of(item[()])
        times = file["time"]
        if times[-1] != summary["simulated_time_s"]:
            return found

        def keep(name, item):
            if isinstance(item, h5py.Dataset) and len(item) == len(times) and not name.startswith(("steps/", "probes/")):
                found[f"last of {name}"] = digest_of(item[-1:])

        file.visititems(keep)
    return found


# What --set makes of the output, and whether a sample falls on the end. No output at all is a row at time 0.
OUTPUTS = ((["output.rate_Hz=2"], True), (["output.rate_Hz=1000", "output.probe_rate_Hz=5000"], True), (["output.probes=[]"], True),
           (["output.rate_Hz=1e-6", "output.probe_rate_Hz=1e-6", "output.probes=[]"], False))


def less_and_more_output(bench, seconds):
    """The way of a run and where it ends do not depend on what is written of it."""
    expected = simulated(bench, drive(seconds), hashes_of_end)
    last = {name for name in expected if name.startswith("last of ")}
    bench.part.require(len(last) > 20, f"simulate: expected a sample at the end, found {len(last)} datasets with one")
    for sets, ends in OUTPUTS:
        options = [word for each in sets for word in ("--set", each)]
        found = simulated(bench, [*drive(seconds), *options], hashes_of_end)
        bench.same(f"simulate with {' '.join(sets)}", expected, found, only=set(expected) - (set() if ends else last))
    bench.row("simulate: step log, sums over all steps and the last sample, if any, with sparse, dense, no probe and no output")


def stopped(arguments, place, at, how):
    """Sends the signal once the run's progress has reached `at` seconds of driving, by its progress lines (one at each tenth).
    True when that ended it."""
    with subprocess.Popen([COMMAND, *arguments], cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        for line in process.stderr:
            reached = re.search(r"([0-9.]+) of [0-9.]+ s$", line)
            if reached and float(reached[1]) >= at:
                process.send_signal(how)
                break
        process.stderr.read()
    return process.returncode == {signal.SIGINT: INTERRUPTED, signal.SIGKILL: -signal.SIGKILL}[how]


def resumed(bench, whole, arguments, seconds, stops):
    """Stopped by Ctrl-C or SIGKILL on the way, behind the first checkpoint (0.5 s) or, each third, before it, and resumed. A run that
    came to its end all the same is no hit."""
    chance, hits, kept = random.Random(SEED), 0, 0
    for number in range(stops):
        place = bench.place()
        run_folder = os.path.join(place, "run")
        how = (signal.SIGINT, signal.SIGKILL)[number % 2]
        early = number % 3 == 2
        at = chance.uniform(0.05, 0.5) if early else chance.uniform(0.8, 0.75 * seconds)
        what = f"simulate stopped by {how.name} at {at:.2f} s ({number})"
        if not stopped(arguments, place, at, how):
            bench.part.note(f"{what}: ended first")
            continue
        hits += 1
        checkpoint = os.path.join(run_folder, "checkpoint")
        if time_of(checkpoint) > 0.0:
            kept += 1
            missing = missing_memory(checkpoint)
            bench.part.require(not missing, f"{what}: the checkpoint holds nothing of {', '.join(missing)}")
        with open(os.path.join(run_folder, "run.json"), encoding="utf-8") as file:
            bench.part.require(json.load(file)["status"] == "stopped", f"{what}: run.json does not say that it is stopped")
        bench.run(place, *arguments, "--resume")
        # Rows are copied table by table on --resume, so run.h5 lays the same chunks out in another order.
        bench.same(f"{what} and resumed", whole, hashes_of_run(run_folder), only=set(whole) - {"run.h5"})
    bench.part.require(2 * kept > hits, f"simulate: expected more than half of {hits} stopped runs to leave a checkpoint, {kept} did")
    bench.part.require(2 * hits >= stops, f"simulate: expected half of {stops} runs stopped on the way, stopped {hits}")
    bench.row(f"simulate: {hits} of {stops} runs of {seconds:g} s stopped on the way, {kept} of them behind a checkpoint, and resumed: "
              "every dataset and run.json, not the order of chunks in run.h5")


def identified(bench, made):
    fits = []
    for threads in THREADS:
        place = bench.place()
        bench.run(place, "identify", RIG, "-o", "fit", "--threads", str(threads))
        fits.append(hashes_of_files(place))
        bench.same(f"identify --threads {threads}", fits[0], fits[-1])
    for name, env in made.items():
        place = bench.place()
        bench.run(place, "identify", RIG, "-o", "fit", env=env)
        bench.same(f"identify with LC_ALL={name}", fits[0], hashes_of_files(place))
    bench.row("identify: 1, 2 and 4 threads" + (", locales" if made else "") + ": bushing.json, fit.json, report")


def shown(bench, arguments, made):
    """Pictures, films, pages and tables of one run, drawn again with other threads and locales."""
    run_folder = os.path.join(bench.place(), "run")
    bench.run(os.path.dirname(run_folder), *arguments)
    commands = [["render", run_folder, "--film", "film.mp4", "--size", "320x180", "--fps", "10"],
                ["render", run_folder, "--frames", "-o", "frames", "--size", "160x90", "--fps", "5"],
                ["plot", run_folder, "--figure", "step_size", "-o", "step_size.svg"],
                ["plot", run_folder, "--figure", "tension", "-o", "tension.png"],
                ["export", run_folder, "--format", "csv", "-o", "csv"],
                ["report", run_folder, "-o", "report.html"]]
    pictures = []
    for env in ({}, {"LP_NUM_THREADS": "0"}, {"LP_NUM_THREADS": "2"}, *made.values()):
        place = bench.place()
        for command in commands:
            bench.run(place, *command, env=env)
        pictures.append(hashes_of_files(place))
        bench.same(f"pictures and pages with {env}", pictures[0], pictures[-1])
    bench.row("render, plot, export, report: threads of the rasteriser, locales")


def work(part, thorough):
    seconds = 5.0 if thorough else 1.5
    with tempfile.TemporaryDirectory() as folder, locales(folder) as made:
        bench = Bench(part, folder)
        arguments = drive(seconds)
        whole = simulated(bench, arguments)
        part.note(f"{len(whole)} hashes a run: {len(whole) - 2} datasets, run.h5 as a whole, run.json without its three times.")
        for _ in range(5 if thorough else 1):
            bench.same("simulate again", whole, simulated(bench, arguments))
        bench.row("simulate again")
        for threads in THREADS:
            bench.same(f"simulate --threads {threads}", whole, simulated(bench, [*arguments, "--threads", str(threads)]))
        bench.row("simulate with 1, 2 and 4 threads, which changes nothing: one thread steps a run")
        surroundings(bench, whole, arguments, thorough)
        less_and_more_output(bench, seconds)
        rich = rich_drive(seconds)
        resumed(bench, simulated(bench, rich), rich, seconds, 12 if thorough else 2)
        shown(bench, drive(0.3), made)
        identified(bench, made if thorough else {})


if __name__ == "__main__":
    main("hashes", "The same input gives the same bytes", work)
