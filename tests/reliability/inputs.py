"""Broken and mutated inputs through the real command: exit code, message, memory and time.

Every file of test_data/broken and every case of its commands.json must be answered in its own words; good files that are cut
short, flipped, stretched or spliced with a fixed seed must be read or refused. Never a signal, never another exit code.
"""

import json
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
from collections import Counter

import h5py

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "pipeline"))
from command import COMMAND, DATA, SHORT_RUN, run  # noqa: E402
from hostile_files import made_at_run_time  # noqa: E402
from hostile_hdf5 import hostile_hdf5  # noqa: E402
from part import main  # noqa: E402

BROKEN = os.path.join(DATA, "broken")
SEED = 20261122
MEMORY = 4 << 30  # bytes of address space: the program and its libraries take about 1.5 GB of it, its data far less
TIME = 60  # s of processor time, on any machine; the slowest refusal takes about one
CORPUS = os.path.join(os.path.dirname(DATA), "tests", "fuzz", "corpus", "json")
ANSWERS = (0, 3, 5)  # done, bad input, cannot read


def limits():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (TIME, TIME))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def content_of(path):
    with open(path, "rb") as file:
        return file.read()


def answer(*arguments, cwd=None):
    """Exit code and the lines of stderr."""
    done = subprocess.run([COMMAND, *map(str, arguments)], cwd=cwd, capture_output=True, preexec_fn=limits,
                          stdin=subprocess.DEVNULL, timeout=10 * TIME)
    return done.returncode, done.stderr.decode("utf-8", "replace").splitlines(), done.stdout.decode("utf-8", "replace")


def broken_files(part):
    """Each file of expected.json through `grouser check`."""
    with open(os.path.join(BROKEN, "expected.json"), encoding="utf-8") as file:
        expected = json.load(file)
    for name, lines in expected.items():
        code, errors, output = answer("check", name, cwd=BROKEN)
        good = lines[0].startswith("ok")
        said = output.splitlines() if good else [line.removeprefix("grouser: error: ") for line in errors]
        wanted = [f"{name}: {lines[0]}"] if good else lines
        part.require(code == (0 if good else 3) and said == wanted, f"check {name}: {code} {said}")
    part.row("broken files of test_data/broken through `grouser check`", len(expected), "each in its own words")


def as_another(arguments):
    """The command line by a user whom permissions bind."""
    if os.getuid() != 0 or shutil.which("setpriv") is None:
        return arguments
    return ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", *arguments]


def extreme_files(part):
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        cases = made_at_run_time(folder)
        for name, words in cases.items():
            done = subprocess.run(as_another([COMMAND, "check", name]), cwd=folder, capture_output=True, preexec_fn=limits,
                                  stdin=subprocess.DEVNULL, timeout=10 * TIME)
            said = done.stderr.decode("utf-8", "replace")
            right = done.returncode in (3, 5) and any(word in said for word in words.split("|"))
            part.require(right, f"check {name}: {done.returncode} {said[:500]}")
            part.require(len(said) < 1_000_000, f"check {name}: a message of {len(said)} bytes")
        part.row("extreme inputs (1e6 brackets, claims of 1e9 rows, holes of 1 TB, pipes, devices, symlink loops, no permission)",
                 len(cases), f"refused within {MEMORY >> 30} GB of address space and {TIME} s")


def small_run(folder):
    path = os.path.join(folder, "run")
    run("simulate", os.path.join(DATA, "scenarios/m113.json"), "-o", path, *SHORT_RUN, "--set", "output.rate_Hz=20",
        "--set", "assembly.settle_time_s=2.6", "--quiet")
    return path


def use_everything(folder, run_folder):
    """Exit codes of all that reads a run folder."""
    codes = []
    for arguments in (["check", run_folder], ["export", run_folder, "-o", folder + "/csv"],
                      ["report", run_folder, "-o", folder + "/report.html"],
                      ["plot", run_folder, "--figure", "speed", "-o", folder + "/figure.png"]):
        codes.append((arguments[0], *answer(*arguments, "--quiet")[:2]))
    return codes


def run_channels(part):
    with tempfile.TemporaryDirectory() as folder:
        good = small_run(folder)
        hostile = os.path.join(folder, "hostile")
        os.mkdir(hostile)
        cases = hostile_hdf5(os.path.join(good, "run.h5"), hostile)
        for name, words in cases.items():
            shutil.copyfile(os.path.join(hostile, name), os.path.join(good, "run.h5"))
            for command, code, errors in use_everything(folder, good):
                said = " ".join(errors)
                part.require(code in ANSWERS, f"{command} on {name}: {code} {said[:500]}")
                if words is not None:
                    part.require(code in (3, 5) and words in said, f"{command} on {name}: {code} {said[:500]}")
        part.row("run.h5 with wrong types, shapes, sizes, links or values (check, export, report, plot of each)",
                 4 * len(cases), "read or refused")


def mutations(content, random_source):
    """One way to spoil bytes."""
    kind = random_source.choice(("cut", "flip", "flip", "digit", "digit", "splice", "zero", "insert"))
    data = bytearray(content)
    at = random_source.randrange(len(data))
    if kind == "cut":
        return bytes(data[:at])
    if kind == "flip":
        for _ in range(random_source.choice((1, 1, 2, 8))):
            data[random_source.randrange(len(data))] ^= 1 << random_source.randrange(8)
    elif kind == "digit":
        places = [i for i, byte in enumerate(data) if byte in b"0123456789"]
        if places:
            data[random_source.choice(places)] = random_source.choice(b"0123456789-.e")
    elif kind == "splice":
        other = random_source.randrange(len(data))
        data[at:at] = data[other:other + random_source.randrange(1, 200)]
    elif kind == "zero":
        end = min(len(data), at + random_source.randrange(1, 64))
        data[at:end] = bytes(end - at)
    else:
        data[at:at] = random_source.choice((b'"', b"{", b"[", b",", b"-", b"e999", b"\xff", b"\x00", b"1e308", b"null"))
    return bytes(data)


def mutated_documents(part, count):
    """Good JSON and CSV files, spoilt, in batches that one process checks."""
    source = random.Random(SEED)
    codes = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for name in ("vehicles", "bushings", "scenarios", "terrain"):
            shutil.copytree(os.path.join(DATA, name), os.path.join(folder, name))
        shutil.copy(os.path.join(BROKEN, "loop.csv"), folder)
        for name in os.listdir(CORPUS):
            shutil.copy(os.path.join(CORPUS, name), os.path.join(folder, "scenarios", "of_corpus_" + name))
        good = [os.path.join(folder, group, name) for group in ("vehicles", "bushings", "scenarios")
                for name in sorted(os.listdir(os.path.join(folder, group)))]
        contents = {path: content_of(path) for path in good}
        table = content_of(os.path.join(folder, "loop.csv"))
        rig = json.dumps({"format": "grouser.rig/1", "specimen": {"name": "s"},
                          "tests": [{"name": "t", "axis": "x", "kind": "cyclic", "frequency_Hz": 1, "file": "TABLE"}]})
        batch = 50
        for first in range(0, count, batch):
            files = []
            for i in range(first, min(count, first + batch)):
                if i % 5 == 0:
                    spoilt = f"table_{i}.csv"
                    with open(os.path.join(folder, spoilt), "wb") as file:
                        file.write(mutations(table, source))
                    files.append(os.path.join(folder, f"rig_{i}.json"))
                    with open(files[-1], "w", encoding="utf-8") as file:
                        file.write(rig.replace("TABLE", spoilt))
                else:
                    path = source.choice(good)
                    files.append(os.path.join(os.path.dirname(path), f"spoilt_{i}.json"))
                    with open(files[-1], "wb") as file:
                        file.write(mutations(contents[path], source))
            done = subprocess.run([COMMAND, "check", "--json", *files], capture_output=True, preexec_fn=limits, timeout=10 * TIME)
            part.require(done.returncode in ANSWERS, f"check of a batch from {first}: {done.returncode} {done.stderr[-500:]}")
            if done.returncode in ANSWERS:
                for entry in json.loads(done.stdout)["files"]:
                    codes["read" if entry["ok"] else "refused"] += 1
            for path in files:
                os.remove(path)
    part.row("mutated JSON and CSV files", count, f"{codes['refused']} refused, {codes['read']} still right, no signal")


def mutated_hdf5(part, count):
    """run.h5 of the program, of which HDF5's checksums know much damage, and the same in the old format, where they know none."""
    source = random.Random(SEED)
    codes = Counter()
    with tempfile.TemporaryDirectory() as folder:
        good = small_run(folder)
        target = os.path.join(good, "run.h5")
        old = os.path.join(folder, "old.h5")
        with h5py.File(target, "r") as new, h5py.File(old, "w", libver="earliest") as file:
            for name in new:
                new.copy(name, file)
        contents = [content_of(target), content_of(old)]
        for i in range(count):
            content = contents[i % 2]
            spoilt = content[:len(content) * (i // 8) // max(1, count // 8)] if i % 8 < 2 else mutations(content, source)
            with open(target, "wb") as file:
                file.write(spoilt)
            arguments = ["export", good, "-o", folder + "/csv"] if i % 20 == 0 else ["check", good]
            code, errors, _ = answer(*arguments, "--quiet")
            codes["read" if code == 0 else "refused"] += 1
            codes["library"] += any("on which the HDF5 library" in line for line in errors)
            part.require(code in ANSWERS, f"{arguments[0]} of mutation {i}: {code} {' '.join(errors)[:500]}")
    part.row("mutated run.h5 (cut, flipped; new and old format)", count,
             f"{codes['refused']} refused, {codes['read']} still right, no signal")
    part.note(f"On {codes['library']} of the mutated HDF5 files the HDF5 library itself crashed or ran out of its limits, "
              "in the child process that surveys a file before it is read.")


def command_case(case, good, out):
    """Exit code and messages of one case: with files in its output folder, or with a damaged file of the run."""
    for name, content in case.get("files", {}).items():
        os.makedirs(out, exist_ok=True)
        with open(os.path.join(out, name), "w", encoding="utf-8") as file:
            file.write(content)
    name, content = case.get("damage", ("run.json", None))
    damaged = os.path.join(good, name)
    kept = content_of(damaged)
    if "damage" in case:
        with open(damaged, "wb") as file:
            file.write(kept[:len(kept) // 2] if content is None else content.encode())
    words = [word.format(RUN=good, OUT=out, DATA=DATA) for word in case["command"]]
    code, errors, _ = answer(*words, "--quiet", cwd=BROKEN)
    with open(damaged, "wb") as file:
        file.write(kept)
    plain = [line.removeprefix("grouser: error: ") for line in errors]
    return code, [line.replace(good, "{RUN}").replace(out, "{OUT}").replace(DATA, "{DATA}") for line in plain]


def commands(part):
    """Cases that need a command of their own: test_data/broken/commands.json."""
    with open(os.path.join(BROKEN, "commands.json"), encoding="utf-8") as file:
        cases = json.load(file)
    with tempfile.TemporaryDirectory() as folder:
        good = small_run(folder)
        for i, case in enumerate(cases):
            code, said = command_case(case, good, os.path.join(folder, f"out_{i}"))
            part.require(code == case["exit"] and said == case["stderr"], f"{' '.join(case['command'])}: {code} {said}")
    part.row("commands on broken inputs (--set, --against, --resume, --camera, ...)", len(cases), "each in its own words")


def mutated_reports(part, count):
    """A report over fit.json and run.json that were spoilt."""
    source = random.Random(SEED)
    codes = Counter()
    with tempfile.TemporaryDirectory() as folder:
        fit = os.path.join(folder, "fit")
        os.mkdir(fit)
        shutil.copy(os.path.join(DATA, "bushings", "reference.json"), os.path.join(fit, "bushing.json"))
        good = {os.path.join(fit, "fit.json"): content_of(os.path.join(CORPUS, "fit.json"))}
        run_file = os.path.join(small_run(folder), "run.json")
        good[run_file] = content_of(run_file)
        for i in range(count):
            path = list(good)[i % 2]
            with open(path, "wb") as file:
                file.write(mutations(good[path], source))
            code, errors, _ = answer("report", os.path.dirname(path), "-o", os.path.join(folder, "report.html"), "--quiet")
            codes["written" if code == 0 else "refused"] += 1
            part.require(code in ANSWERS, f"report on mutation {i} of {path}: {code} {' '.join(errors)[:500]}")
    part.row("reports over mutated fit.json and run.json", count,
             f"{codes['refused']} refused, {codes['written']} written, no signal")


def work(part, thorough):
    broken_files(part)
    extreme_files(part)
    commands(part)
    run_channels(part)
    mutated_documents(part, 4000 if thorough else 250)
    mutated_hdf5(part, 1000 if thorough else 40)
    mutated_reports(part, 200 if thorough else 10)
    if thorough:
        part.note(f"Mutations are drawn from seed {SEED}; each process had {MEMORY >> 30} GB of address space and {TIME} s of processor time.")


if __name__ == "__main__":
    main("inputs", "Broken and hostile inputs", work)
