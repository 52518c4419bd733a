"""The whole pipeline twice, in two folders at once, and every byte of every file compared.

The only thing that may differ is what a clock measured: three numbers of run.json. They are made alike once run.json has been
compared without them, so that films, pictures and pages are compared to the last byte."""

import filecmp
import json
import os
import shutil
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

sys.path.insert(0, os.path.join(os.environ["GROUSER_SOURCE_DIR"], "tests", "pipeline"))
from command import CLOCK, DATA, SHORT_RUN, run  # noqa: E402
from part import main  # noqa: E402

RIG, PROTOCOL = os.path.join(DATA, "rig/reference/rig.json"), os.path.join(DATA, "rig/protocol/rig.json")
RUNS = ("run_a", "run_b")


def compute(folder, thorough):
    """From measurements to channels."""
    short = [] if thorough else SHORT_RUN
    run("identify", RIG, "-o", "fit", cwd=folder)
    run("rig", PROTOCOL, "--bushing", "fit/bushing.json", "-o", "rig", cwd=folder)
    for name in RUNS:
        run("simulate", os.path.join(DATA, "scenarios", name + ".json"), "--bushing", "fit/bushing.json", "-o", name, *short,
            cwd=folder)


def show(folder, _):
    """From channels to films, pictures and pages."""
    run("render", "run_a", "--film", "run_a/film.mp4", "--size", "320x180", "--fps", "10", cwd=folder)
    run("render", "run_b", "--frames", "-o", "frames", "--size", "160x90", "--fps", "5", cwd=folder)
    run("render", "run_a", "--still", "0.1", "--size", "320x180", "-o", "stills", cwd=folder)
    for figure in ("tension.png", "tension.svg", "step_size.png"):
        run("plot", "run_a", "--figure", figure.split(".")[0], "-o", "plots/" + figure, cwd=folder)
    run("export", "run_b", "--format", "csv", "-o", "csv", cwd=folder)
    run("report", "fit", "run_a", "-o", "report.html", cwd=folder)
    run("report", *RUNS, "-o", "comparison.html", cwd=folder)
    run("report", "run_a", "--against", "csv/probes_sprocket_torque.csv", "-o", "measured.html", cwd=folder)


def in_both(work, folders, thorough):
    with ThreadPoolExecutor(len(folders)) as pool:
        for job in [pool.submit(work, folder, thorough) for folder in folders]:
            job.result()


def files_of(folder):
    return {os.path.relpath(os.path.join(root, name), folder) for root, _, files in os.walk(folder) for name in files}


def compare_checkpoints(part, name, folders):
    """Behind the line with the checksum, all but two neighbouring numbers: the times of assembly and run so far."""
    payloads = []
    for folder in folders:
        with open(os.path.join(folder, name, "checkpoint"), "rb") as file:
            payloads.append(file.read().split(b"\n", 1)[1])
    one, two = payloads
    others = [place for place, (a, b) in enumerate(zip(one, two)) if a != b]
    part.require(len(one) == len(two) and (not others or others[-1] - others[0] < 16),
                 f"{name}/checkpoint differs in more than what a clock measured")


def take_clock(part, folders):
    """Compares both run.json of each run without what a clock measured, then gives both the times of the first."""
    for name in RUNS:
        documents = []
        for folder in folders:
            with open(os.path.join(folder, name, "run.json"), encoding="utf-8") as file:
                documents.append(json.load(file))
            for key in CLOCK:
                part.require(documents[-1].pop(key, None) is not None, f"{name}/run.json has no {key}")
        part.require(documents[0] == documents[1], f"{name}/run.json differs in more than what a clock measured")
        clocked = ["run.json"]
        if all(os.path.exists(os.path.join(folder, name, "checkpoint")) for folder in folders):  # of runs above a second
            compare_checkpoints(part, name, folders)
            clocked.append("checkpoint")
        for file in clocked:
            shutil.copyfile(os.path.join(folders[0], name, file), os.path.join(folders[1], name, file))


def compare(part, folders):
    one, two = map(files_of, folders)
    part.require(one == two, f"files in one folder alone: {sorted(one ^ two)}")
    same, size = 0, 0
    for path in sorted(one & two):
        pair = [os.path.join(folder, path) for folder in folders]
        equal = filecmp.cmp(*pair, shallow=False)
        part.require(equal, f"{path} differs")
        same += equal
        size += os.path.getsize(pair[0])
    part.row("files of the whole pipeline, made twice and compared byte by byte", same,
             f"all the same, {size / 1e6:.0f} MB")


def work(part, thorough):
    with tempfile.TemporaryDirectory(prefix="grouser_twice_") as home:
        folders = [os.path.join(home, name) for name in ("one", "another")]
        for folder in folders:
            os.mkdir(folder)
        in_both(compute, folders, thorough)
        take_clock(part, folders)
        in_both(show, folders, thorough)
        compare(part, folders)
    part.note("Taken out of the comparison: what a clock measured, which is " + ", ".join(CLOCK) +
              " in run.json, and the two of them that a checkpoint holds.")


if __name__ == "__main__":
    main("twice", "The pipeline twice, byte by byte", work)
