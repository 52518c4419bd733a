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

import h5py

import injection
from checkpoint import time_of
from injection import children_of, finish, must, run, seeded, short_data, spread, stages, start, told

SEED = 20261122
CHANGES = "wsnc"  # writes, syncs, names, creations
TRIES = 4  # for a kill that came too late, each in half the time of the one before
LEAST_KILLS = 200  # that struck a living command at a random time, in the long form
LEAST_RESUMED = {False: 2, True: 15}  # killed runs of a stage, by --thorough, that went on from a checkpoint


class Count:
    """What trials of kills came to."""

    def __init__(self, struck=0, tried=0, resumed=0, wrong=()):
        self.struck, self.tried, self.wrong = struck, tried, list(wrong)
        self.resumed = resumed  # from a checkpoint behind the start of the run

    def __add__(self, other):
        return Count(self.struck + other.struck, self.tried + other.tried, self.resumed + other.resumed, self.wrong + other.wrong)


def checkpoint_waits(folder):
    """True where a run in progress left a checkpoint behind its start, which --resume goes on from."""
    out = os.path.join(folder, "out")
    if not os.path.exists(os.path.join(out, "run.json")) or time_of(os.path.join(out, "checkpoint")) == 0.0:
        return False
    return json.loads(injection.read(os.path.join(out, "run.json")))["status"] == "stopped"


def after(stage, folder, what, struck, tried):
    """Looks at what a kill left and at what the next command makes of it."""
    resumed = checkpoint_waits(folder)
    wrong = stage.torn(folder) + stage.recover(folder)
    shutil.rmtree(folder)
    told_at_once = f"{stage.name}, {what}: {'; '.join(wrong[:4])}" + (f" and {len(wrong) - 4} more" if wrong[4:] else "")
    return Count(struck, tried, int(resumed), [told_at_once] if wrong else [])


def instead(source):
    """Puts the file of another folder in a file's place, or nothing where it has none."""
    def change(folder, path):
        here, there = os.path.join(folder, path), os.path.join(source, path)
        os.makedirs(os.path.dirname(here), exist_ok=True)
        if os.path.exists(there):
            shutil.copy(there, here)
        elif os.path.exists(here):
            os.remove(here)
    return change


def cut(folder, path):
    os.truncate(os.path.join(folder, path), os.path.getsize(os.path.join(folder, path)) // 2)


def drop_row(folder, path):
    with h5py.File(os.path.join(folder, path), "r+") as file:
        file["time"].resize(len(file["time"]) - 1, 0)


def change_number(folder, path):
    with h5py.File(os.path.join(folder, path), "r+") as file:
        file["time"][1] += 1e-9


def say_stopped(folder, path):
    summary = json.loads(injection.read(os.path.join(folder, path)))
    with open(os.path.join(folder, path), "w", encoding="utf-8") as file:
        json.dump({**summary, "status": "stopped"}, file)


def forgeries(stage):
    """What no kill may leave: its name, a whole folder and what is done to files of it."""
    old, new = stage.old_folder(), stage.new_folder()
    largest = max((path for path in stage.new if path != "checkpoint"), key=lambda path: os.path.getsize(os.path.join(new, "out", path)))
    made = [("a file cut short", new, [(cut, largest)])]
    if stage.resumed:
        stopped = (say_stopped, "run.json")
        made += [("the new summary beside the old files", old, [(instead(new), "run.json")]),
                 ("the old summary beside the new files", new, [(instead(old), "run.json")]),
                 ("the new summary beside the old channels", new, [(instead(old), "run.h5")]),
                 ("the new summary beside channels without the last row", new, [(drop_row, "run.h5")]),
                 ("the new summary beside another number", new, [(change_number, "run.h5")]),
                 ("the new summary beside the old scenario", new, [(instead(old), "inputs/scenario.json")]),
                 ("a run in progress beside another number", new, [stopped, (change_number, "run.h5")]),
                 ("a run in progress with a checkpoint and the old channels", new, [stopped, (instead(old), "run.h5")])]
    return [(what, base, [(change, os.path.join("out", path)) for change, path in changes]) for what, base, changes in made]


def forge(stage, rows):
    """An oracle that is to be believed sees no loss in what is whole, and one in everything that is forged."""
    failures = [f"{stage.name}: a loss is seen in what is whole: {stage.torn(folder)}"
                for folder in (stage.old_folder(), stage.new_folder()) if stage.torn(folder)]
    made = forgeries(stage)
    for what, base, changes in made:
        folder = os.path.join(stage.home, "forged")
        shutil.copytree(base, folder)
        for change, path in changes:
            change(folder, path)
        if not stage.torn(folder):
            failures.append(f"{stage.name}: {what}: no loss is seen")
        ended = stage.resumed and os.path.exists(os.path.join(folder, "out", "run.json")) and say_stopped not in dict(changes)
        if ended and not stage.recover(folder):
            failures.append(f"{stage.name}: {what}: the next command covers the loss")
        shutil.rmtree(folder)
    rows.append({"what": f"{stage.name}: forged losses", "count": len(made), "result": f"{len(made) - len(failures)} seen"})
    return told(failures)


def stamp(path):
    """Which file bears a name; None for no file."""
    try:
        found = os.stat(path)
    except FileNotFoundError:
        return None
    return found.st_ino, found.st_mtime_ns


def wait_for_checkpoint(process, path, earlier):
    """Until a checkpoint of this command stands, or the command ended."""
    while process.poll() is None and stamp(path) in (None, earlier):
        time.sleep(0.005)


def killed_at(arguments, folder, delay, behind_checkpoint=False):
    """True when the kill struck: the command ended by it, not before it."""
    checkpoint = os.path.join(folder, "out", "checkpoint")
    earlier = stamp(checkpoint)
    process = start(arguments, folder)
    if behind_checkpoint:
        wait_for_checkpoint(process, checkpoint, earlier)
    time.sleep(delay)
    process.kill()
    return process.wait() == -signal.SIGKILL


def kill_at_random(stage, number):
    """One trial; a run is also killed while it is resumed, and in every other trial behind its first checkpoint."""
    chance = seeded(f"{SEED} {stage.name} {number}")
    behind_checkpoint = stage.resumed and number % 2 == 1
    delays = [chance.uniform(0.0, (0.3 if behind_checkpoint else 1.05) * stage.duration)]
    kills = 0
    for late in range(TRIES):
        folder = stage.trial(f"random_{number}")
        kills = int(killed_at(stage.arguments, folder, delays[0], behind_checkpoint))
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
    what = "killed after " + ("a checkpoint and " if behind_checkpoint else "") + " and ".join(f"{delay:.3f} s" for delay in delays)
    return after(stage, folder, what, kills, 1)


def kill_at_call(stage, number, lines, do):
    """One trial: killed before a call, or amid it."""
    folder = stage.trial(f"call_{number}_{do}")
    done = run(stage.arguments, folder, injection.environment(under=folder, calls=CHANGES, at=number, do=do))
    line = lines[number - 1].split(" ", 2)
    what = f"{'killed before' if do == 'kill' else 'killed amid'} call {number} ({line[1]} {os.path.basename(line[2])})"
    # Threads may make a call more or less than when they were counted.
    return after(stage, folder, what, int(done.returncode == -signal.SIGKILL), 1)


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
    """`demo` is killed again and again in one folder, then left alone."""
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
    wrong += [f"{name}: {path} differs afterwards" for path in injection.differing(injection.tree(whole), injection.tree(folder))
              if os.path.basename(path) in ("run.h5", "run.json")]
    return Count(hit, kills, 0, wrong)


def row(rows, what, count):
    """A row of kills that struck; at least half of those tried must, or the row says nothing. Returns what is wrong."""
    rows.append({"what": what, "count": count.struck, "result": f"{len(count.wrong)} losses"})
    print(f"kills: {what}: {count.struck} struck of {count.tried} tried, {len(count.wrong)} losses", file=sys.stderr, flush=True)
    enough = 2 * count.struck >= count.tried
    return told(count.wrong + ([] if enough else [f"{what}: expected half of {count.tried} kills to strike, {count.struck} did"]))


def row_of_resumed(rows, stage, count, least):
    """How many of a stage's trials went on from a checkpoint, without which they say nothing of resuming."""
    what = f"{stage.name}: killed behind a checkpoint, and resumed from it"
    rows.append({"what": what, "count": count.resumed, "result": f"of {count.struck} that were killed"})
    print(f"kills: {what}: {count.resumed}", file=sys.stderr, flush=True)
    return [] if count.resumed >= least else told([f"{what}: expected at least {least}, found {count.resumed}"])


def calls_to_kill_at(stage, lines, amount, chance):
    """Numbers of calls; of a run half of them, the larger one, behind its last checkpoint."""
    if not stage.resumed:
        return spread(len(lines), amount, chance)
    last = max(number for number, line in enumerate(lines, 1) if line.endswith("/checkpoint"))
    behind = spread(len(lines) - last, amount - amount // 2, chance)
    return spread(last, amount // 2, chance) + [last + number for number in behind]


def kill_stage(stage, rows, workers, random_kills, calls, least_resumed):
    """All trials of a stage. Returns the kills at random times that struck, and what is wrong."""
    wrong = forge(stage, rows)
    lines = stage.count_calls(CHANGES)
    chance = seeded(f"{SEED} calls {stage.name}")
    at_random = [workers.submit(kill_at_random, stage, number) for number in range(random_kills)]
    at_calls = [workers.submit(kill_at_call, stage, number, lines, do) for do in ("kill", "half")
                for number in calls_to_kill_at(stage, lines, calls, chance)]
    by_chance, by_call = (sum((job.result() for job in jobs), Count()) for jobs in (at_random, at_calls))
    wrong += row(rows, f"{stage.name}: kills at random times", by_chance)
    wrong += row(rows, f"{stage.name}: kills before and amid calls that change files, of {len(lines)} calls", by_call)
    if stage.resumed:
        wrong += row_of_resumed(rows, stage, by_chance + by_call, least_resumed)
    return by_chance.struck, wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--thorough", action="store_true", help="the long form")
    parser.add_argument("--only", metavar="STAGE", help="one stage of the pipeline")
    parser.add_argument("-o", metavar="FILE.json", dest="output")
    options = parser.parse_args()
    random_kills, calls, demo_kills = (21, 12, 6) if options.thorough else (2, 1, 0)
    rows, failures, random_total = [], [], 0
    with tempfile.TemporaryDirectory() as home, ThreadPoolExecutor(2) as workers:
        for stage in stages(home):
            if options.only not in (None, stage.name):
                continue
            stage.prepare(home)
            struck, wrong = kill_stage(stage, rows, workers, random_kills, calls, LEAST_RESUMED[options.thorough])
            random_total += struck
            failures += wrong
            shutil.rmtree(stage.home)
        for more in ([], ["--study", "stiffness"]) if demo_kills and not options.only else []:
            count = kill_demo(home, more, demo_kills)
            random_total += count.struck
            failures += row(rows, " ".join(["demo", *more]) + ": kills of all its processes at random times", count)
    if options.thorough and not options.only and random_total < LEAST_KILLS:
        failures += told([f"expected at least {LEAST_KILLS} kills that strike at random times, found {random_total}"])
    rows.insert(0, {"what": "kills at random times, together", "count": random_total, "result": f"{len(failures)} losses"})
    notes = ["A loss is a file that is neither the old one nor the new one, the summary of one run beside a file of another, a run that "
             "--resume does not take to the same bytes in every dataset and the same summary, or a temporary file that the next "
             "command leaves. Before anything is killed, forged losses must be seen as such."]
    sys.exit(finish("kills", "Killed at any moment", rows, notes, failures, options.output))


if __name__ == "__main__":
    main()
