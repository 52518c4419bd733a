"""Runs that must fail: each ends with exit code 4 and says when, where, what quantity, its value and what to do; what it computed
until then can be read, reported, drawn and exported."""

import json
import math
import os
import re
import subprocess
import sys
import tempfile

import h5py

sys.path.insert(0, os.path.join(os.environ["GROUSER_SOURCE_DIR"], "tests", "pipeline"))
from command import COMMAND, DATA, run  # noqa: E402
from part import main  # noqa: E402

NUMERICAL_FAILURE = 4
LINK = r"link \d+ of the (left|right) track"
NUMBER = r"-?[\d.]+(e[+-]\d+)?"


def both(path, value):
    return [f"vehicle./{side}/{path}={value}" for side in ("left", "right")]


def drives(times, speeds):
    return [f"drive.{side}.{key}={value}" for side in ("left", "right")
            for key, value in (("time_s", times), ("speed_rad_per_s", speeds))]


# What is provoked: scenario, values set, what the message must say. All fail on their way.
FAIL_UNDER_WAY = {
    "step underflow": (
        "run_a", ["integrator.min_step_ms=0.15", "integrator.velocity_tolerance_mm_per_s=0.1"],
        [rf"at {NUMBER} s, {LINK}: its (angular )?acceleration (along|about) [xyz] jumps by {NUMBER} (m|rad)/s2 within the "
         r"least step \(integrator.min_step, 0.15 ms\)", "step underflow; "]),
    "a least step above the stable one": (
        "run_a", ["integrator.min_step_ms=0.19"],
        [rf"at {NUMBER} s, {LINK}: ", r"integrator.min_step \(0.19 ms\) is too long for ", "check these and the stiffness"]),
    "divergence at a fixed step": (
        "run_a", ["integrator.fixed_step_ms=0.6"],
        [rf"energy residual {NUMBER} .* at {NUMBER} s", rf"most often {LINK}", rf"reduce integrator.fixed_step, which is {NUMBER}"]),
    "chatter of steps that are too bold": (
        "run_a", ["integrator.stability_fraction=5"],
        [rf"energy residual {NUMBER} .* at {NUMBER} s", LINK, "reduce integrator."]),
    "a number that overflows": (
        "run_a", ["drive.left.speed_rad_per_s=[0, 1e200, 1e200, 0]"],
        [rf"at {NUMBER} s, .*: its .* is (nan|-nan|inf|-inf) ", "the run diverged; look there"]),
    "a sprocket faster than any step follows": (
        "run_a", ["drive.left.speed_rad_per_s=[0, 1e4, 1e4, 0]"],
        [rf"at {NUMBER} s, {LINK}: its .* jumps by {NUMBER} ", "a jump of the drive"]),
    "a thrown track": (
        "run_b", [*both("track/link/guide/stiffness_N_per_m", "1e4"), *both("track/pre_tension_kN", "50")],
        [rf"(left|right) track thrown at {NUMBER} s: {LINK} stands {NUMBER} mm beside (left|right)/\w+", "would hold it"]),
    "skipped teeth": (
        "run_a", [*drives("[0, 1.5, 2.2]", "[0, 12, 0]"), *both("idler/tensioner/stiffness_N_per_m", "1e6"),
                  *both("track/pre_tension_kN", "50")],
        [rf"(left|right) track skipped a tooth at {NUMBER} s, {LINK} on the sprocket: {NUMBER} links passed it for {NUMBER} teeth",
         rf"went slack at {NUMBER} s, when the idler had given way by {NUMBER} mm", "would hold it"]),
}
# These fail while the vehicle is put on its ground: there is no run yet.
FAIL_IN_ASSEMBLY = {
    "a singular mass matrix": (
        "run_a", ["vehicle./left/support_rollers/0/mass_kg=1e-320",
                  "vehicle./left/support_rollers/0/inertia_kg_m2=[1e-320, 1e-320, 1e-320]"],
        [rf"assembly, {NUMBER} s after its start: left/roller_1: its inertia about its joint is {NUMBER} kg m2: the mass matrix is "
         "singular; give it"]),
    "links that weigh a gram": (
        "run_a", ["vehicle./left/track/link/mass_kg=1e-3"],
        [rf"assembly, {NUMBER} s after its start: {LINK}: its ", "it is too stiff for its mass and inertia"]),
    "a track that cannot be closed": (
        "run_a", both("track/links", "90"), ["assembly of the left track: 90 links of 0.1940 m", "change the number of links"]),
}


def simulate(folder, scenario, sets):
    options = [word for each in (*sets, "assembly.settle_time_s=3") for word in ("--set", each)]
    return subprocess.run([COMMAND, "simulate", os.path.join(DATA, "scenarios", scenario + ".json"), "-o", "run", "--quiet",
                           *(("--set", "duration_s=3") if not any("time_s=" in each for each in sets) else ()), *options],
                          cwd=folder, capture_output=True, text=True, check=False)


def says(part, name, message, expected):
    for pattern in expected:
        part.require(re.search(pattern, message), f"{name}: expected /{pattern}/, found: {message}")


def not_finite(file):
    """Datasets that hold a number that is none."""
    wrong = []

    def look(path, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind == "f":
            if not all(map(math.isfinite, item[()].ravel().tolist())):
                wrong.append(path)

    file.visititems(look)
    return wrong


def recorded(part, name, folder, summary):
    """All that was computed until the failure stands in run.h5: every step, and the rows that were due. Time 0 is no step."""
    end, stated = summary["simulated_time_s"], re.search(rf"at ({NUMBER}) s", summary["message"])
    part.require(stated and abs(float(stated[1]) - end) < 1e-4, f"{name}: ends at {end} s, and says: {summary['message']}")
    with open(os.path.join(folder, "run/inputs/scenario.json"), encoding="utf-8") as file:
        output = json.load(file)["output"]
    with h5py.File(os.path.join(folder, "run/run.h5"), "r") as file:
        part.require(not_finite(file) == [], f"{name}: no numbers in {not_finite(file)}")
        for path, before, interval in (("time", math.nan, 1 / output["rate_Hz"]),
                                       ("probes/time", math.nan, 1 / output["probe_rate_Hz"]), ("steps/time", 0.0, 0.0)):
            last = [before, *file[path]][-1]
            part.require(-1e-9 < end - last < interval + 1e-9, f"{name}: /{path} ends at {last} s, the run at {end} s")


def readable(part, name, folder, pictures):
    """Every way to look at the rows until the failure."""
    looks = [["report", "run", "-o", "report.html"], ["plot", "run", "--figure", "tension", "-o", "tension.svg"],
             ["export", "run", "--format", "csv", "-o", "csv"]]
    if pictures:
        looks.append(["render", "run", "--still", "0", "-o", "stills", "--size", "160x90"])
    for arguments in looks:
        run(*arguments, cwd=folder)
    with open(os.path.join(folder, "report.html"), encoding="utf-8") as file:
        part.require("failed" in file.read(), f"{name}: the report does not say that the run failed")
    return len(looks)


def under_way(part, thorough):
    looked = 0
    for number, (name, (scenario, sets, expected)) in enumerate(FAIL_UNDER_WAY.items()):
        with tempfile.TemporaryDirectory() as folder:
            done = simulate(folder, scenario, sets)
            part.require(done.returncode == NUMERICAL_FAILURE, f"{name}: ended with {done.returncode}: {done.stderr}")
            with open(os.path.join(folder, "run/run.json"), encoding="utf-8") as file:
                summary = json.load(file)
            part.require(summary["status"] == "failed", f"{name}: status {summary['status']}")
            part.require(summary["message"] in done.stderr, f"{name}: stderr says otherwise: {done.stderr}")
            says(part, name, summary["message"], expected)
            recorded(part, name, folder, summary)
            looked += readable(part, name, folder, thorough or number == 0)
    part.row("runs that fail under way: " + ", ".join(FAIL_UNDER_WAY), len(FAIL_UNDER_WAY),
             "exit code 4, status failed, with time, part, quantity, value and remedy; run.h5 holds every step until then")
    part.row("reports, plots, tables and pictures of those runs", looked, "all made, every number finite")


def in_assembly(part):
    for name, (scenario, sets, expected) in FAIL_IN_ASSEMBLY.items():
        with tempfile.TemporaryDirectory() as folder:
            done = simulate(folder, scenario, sets)
            part.require(done.returncode == NUMERICAL_FAILURE, f"{name}: ended with {done.returncode}: {done.stderr}")
            says(part, name, done.stderr, expected)
            part.require(not os.path.exists(os.path.join(folder, "run/run.h5")), f"{name}: left a run behind")
    part.row("vehicles that cannot be assembled: " + ", ".join(FAIL_IN_ASSEMBLY), len(FAIL_IN_ASSEMBLY),
             "exit code 4 with time, part, quantity, value and remedy")


def work(part, thorough):
    under_way(part, thorough)
    in_assembly(part)
    part.note("A state that is no number is written into a sound vehicle by unit tests (tests/simulator/test_failures.cpp): no file "
              "can hold one.")


if __name__ == "__main__":
    main("numerics", "Numbers that go wrong are found and named", work)
