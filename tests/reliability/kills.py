"""Kills the commands of the pipeline with SIGKILL, at random times and at every call that changes a file, and looks at
what is left: each file is the old one or the new one, and the next command ends as if nothing had happened."""

import argparse
import json
import os
import shutil
import signal
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

import injection
from injection import children_of, finish, must, run, seeded, short_data, spread, stages, start, told

SEED = 20261122
CHANGES = "wsnc"  # writes, syncs, names, creations
TRIES = 4  # for a kill that came too late, each in half the time of the one before
LEAST_KILLS = 200  # that struck a living command at a random time, in the long form


def after(stage, folder, what):
    """What is wrong behind a kill: nothing, or one text."""
    wrong = stage.torn(folder) + stage.recover(folder)
    shutil.rmtree(folder)
    return [f"{stage.name}, {what}: {'; '.join(wrong[:4])}" + (f" and {len(wrong) - 4} more" if wrong[4:] else "")
            ] if wrong else []


def killed_at(arguments, folder, delay):
    """True when the kill struck: the command ended by it, not before it."""
    process = start(arguments, folder)
    time.sleep(delay)
    process.kill()
    return process.wait() == -signal.SIGKILL


def kill_at_random(stage, number):
    """One trial; a run is also killed while it is resumed. Returns the kills that struck, those that were tried, what is wrong."""
    chance = seeded(f"{SEED} {stage.name} {number}")
    delays = [chance.uniform(0.0, 1.05 * stage.duration)]
    kills = late = 0
    for late in range(TRIES):
        folder = stage.trial(f"random_{number}")
        kills = int(killed_at(stage.arguments, folder, delays[0]))
        if kills or late == TRIES - 1:
            break
        shutil.rmtree(folder)
        delays[0] /= 2
    while stage.resumed and chance.random() < 0.5:
        delays.append(chance.uniform(0.0, stage.duration / 2))  # from a checkpoint there is less to do
        struck = killed_at([*stage.arguments, "--resume"], folder, delays[-1])
        kills += struck
        if not struck:
            break  # it ended, and nothing of it is left to resume
    return kills, late + len(delays), after(stage, folder, "killed after " + " and ".join(f"{delay:.3f} s" for delay in delays))


def kill_at_call(stage, number, lines, do):
    """One trial: killed before a call, or amid it."""
    folder = stage.trial(f"call_{number}_{do}")
    done = run(stage.arguments, folder, injection.environment(under=folder, calls=CHANGES, at=number, do=do))
    line = lines[number - 1].split(" ", 2)
    what = f"{'killed before' if do == 'kill' else 'killed amid'} call {number} ({line[1]} {os.path.basename(line[2])})"
    # Threads may make a call more or less than when they were counted.
    return int(done.returncode == -signal.SIGKILL), 1, after(stage, folder, what)


def unfinished(folder):
    """Files that are not whole, by their last bytes or by reading them."""
    wrong = []
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            if injection.is_temporary(os.path.relpath(path, folder)):
                continue
            try:
                if name.endswith(".json"):
                    json.loads(injection.read(path))
                elif name.endswith(".h5"):
                    injection.digest_of_channels(path)
                elif name.endswith((".html", ".png", ".mp4")):
                    end = {"html": b"</html>", "png": b"IEND", "mp4": b"grouser film of"}[name.rsplit(".", 1)[1]]
                    if end not in injection.read(path):
                        wrong.append(f"{os.path.relpath(path, folder)} is cut short")
            except (OSError, ValueError) as error:
                wrong.append(f"{os.path.relpath(path, folder)} cannot be read: {error}")
    return wrong


def end_all(process):
    """The command and the processes that it started, at once: what a loss of power does. True when it was still alive."""
    children = children_of(process.pid)
    process.kill()
    for child in children:
        try:
            os.kill(child, signal.SIGKILL)
        except ProcessLookupError:
            pass
    return process.wait() == -signal.SIGKILL


def kill_demo(home, more, kills):
    """`demo` is killed again and again in one folder, then left alone. Returns the kills and what is wrong."""
    name = "demo" + "".join(more)
    data = os.path.join(home, name + "_data")
    os.mkdir(data)
    arguments = ["demo", *more, "-o", "out", "--data", short_data(data)]
    whole, folder = os.path.join(home, name + "_whole"), os.path.join(home, name)
    os.mkdir(whole)
    os.mkdir(folder)
    begun = time.monotonic()
    must(arguments, whole)
    duration = time.monotonic() - begun
    chance, hit, wrong = seeded(f"{SEED} {name}"), 0, []
    for _ in range(kills):
        process = start(arguments, folder)
        time.sleep(chance.uniform(0.0, duration))
        hit += end_all(process)
        wrong += [f"{name}: {fault}" for fault in unfinished(os.path.join(folder, "out"))]
    must(arguments, folder)
    wrong += [f"{name}: {fault}" for fault in unfinished(os.path.join(folder, "out"))]
    left = {os.path.relpath(os.path.join(root, file), folder) for root, _, files in os.walk(folder) for file in files}
    asked = {os.path.relpath(os.path.join(root, file), whole) for root, _, files in os.walk(whole) for file in files}
    wrong += [f"{name}: {path} is litter, or missing" for path in sorted(left ^ asked)]
    return hit, wrong


def row(rows, what, hit, tried, wrong):
    """A row of kills that struck; at least half of those tried must, or the row says nothing."""
    rows.append({"what": what, "count": hit, "result": f"{len(wrong)} losses"})
    print(f"kills: {what}: {hit} struck of {tried} tried, {len(wrong)} losses", file=sys.stderr, flush=True)
    return wrong + ([] if 2 * hit >= tried else told([f"{what}: expected half of {tried} kills to strike, {hit} did"]))


def added(jobs):
    """Kills that struck, kills tried, what is wrong, of all trials."""
    done = [job.result() for job in jobs]
    return sum(one[0] for one in done), sum(one[1] for one in done), told([fault for one in done for fault in one[2]])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--thorough", action="store_true", help="the long form")
    parser.add_argument("--only", metavar="STAGE", help="one stage of the pipeline")
    parser.add_argument("-o", metavar="FILE.json", dest="output")
    options = parser.parse_args()
    random_kills, calls, demo_kills = (21, 12, 6) if options.thorough else (2, 1, 0)
    rows, failures, random_total = [], [], 0
    with tempfile.TemporaryDirectory() as home, ThreadPoolExecutor(2) as workers:
        chosen = [stage for stage in stages(home) if options.only in (None, stage.name)]
        for stage in chosen:
            stage.prepare(home)
            lines = stage.count_calls(CHANGES)
            chance = seeded(f"{SEED} calls {stage.name}")
            jobs = [workers.submit(kill_at_random, stage, number) for number in range(random_kills)]
            at_calls = [workers.submit(kill_at_call, stage, number, lines, do) for do in ("kill", "half")
                        for number in spread(len(lines), calls, chance)]
            hit, tried, wrong = added(jobs)
            failures += row(rows, f"{stage.name}: kills at random times", hit, tried, wrong)
            random_total += hit
            failures += row(rows, f"{stage.name}: kills before and amid calls that change files, of {len(lines)} calls",
                            *added(at_calls))
            shutil.rmtree(stage.home)
        for more in ([], ["--study", "stiffness"]) if demo_kills and not options.only else []:
            hit, wrong = kill_demo(home, more, demo_kills)
            random_total += hit
            failures += row(rows, " ".join(["demo", *more]) + ": kills of all its processes at random times", hit, demo_kills,
                            told(wrong))
    if options.thorough and not options.only and random_total < LEAST_KILLS:
        failures += told([f"expected at least {LEAST_KILLS} kills that strike at random times, found {random_total}"])
    rows.insert(0, {"what": "kills at random times, together", "count": random_total, "result": f"{len(failures)} losses"})
    notes = ["A loss is a file that is neither the old one nor the new one, a run that --resume does not take to the "
             "same bytes in every dataset and the same summary, or a temporary file that the next command leaves."]
    sys.exit(finish("kills", "Killed at any moment", rows, notes, failures, options.output))


if __name__ == "__main__":
    main()
