"""Disks that fill up or break, folders that are read-only, inputs and outputs that vanish, closed pipes, signals, too little memory,
two processes at once and a clock that runs backwards: a clear message, the right exit code, nothing lost."""

import argparse
import errno
import functools
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

import injection
from injection import COMMAND, DATA, children_of, environment, finish, read, run, seeded, short_data, spread, stages, told, tree
from kills import CHANGES, SEED, Count

DONE, BAD_INPUT, FILE_FAILURE, INTERNAL_ERROR, INTERRUPTED = 0, 3, 5, 70, 130
LOOKS = "or"  # opens of what is there, reads
INPUTS = "inputs"  # in the folder of every trial
GONE = os.strerror(errno.ENOENT)


def own_inputs(stage, made):
    """Every trial of the stage gets inputs of its own, of those in `made` and of the data, which it may lose."""
    for source, names in ((made, os.listdir(made)), (DATA, ("scenarios", "vehicles", "bushings", "terrain"))):
        if any(word.startswith(source + os.sep) for word in stage.arguments):
            for name in names:
                shutil.copytree(os.path.join(source, name), os.path.join(stage.old_folder(), INPUTS, name))
        stage.arguments = [word.replace(source + os.sep, INPUTS + os.sep) for word in stage.arguments]


class Measured:
    """The stage with its own inputs and without a fault: its new results, its calls, and what it takes."""

    def __init__(self, stage):
        folder, log = stage.trial("measured"), os.path.join(stage.home, "looks")
        env = environment(under=folder, calls=LOOKS, log=log)
        env["MALLOC_ARENA_MAX"] = "1"  # no addresses that are reserved, and not needed
        process = injection.start(stage.arguments, folder, env)
        self.peak = 0  # kB of addresses
        while process.poll() is None:
            with open(f"/proc/{process.pid}/status", encoding="utf-8") as file:
                self.peak = max([self.peak, *(int(line.split()[1]) for line in file if line.startswith("VmPeak"))])
            time.sleep(0.01)
        if process.returncode != DONE:
            raise AssertionError(f"{stage.name} ended with {process.returncode} under the interposer")
        stage.new = tree(os.path.join(folder, "out"))
        self.largest = max(os.path.getsize(os.path.join(folder, "out", name)) for name in stage.new)  # bytes
        lines = [line.split(" ", 2)[1:] for line in read(log).decode().splitlines()]
        self.looks = len(lines)
        self.opened = [path for kind, path in lines if kind == "o" and path.startswith(INPUTS + os.sep)]
        self.changes = len(stage.count_calls(CHANGES))
        shutil.rmtree(folder)


class Trial:
    """One fault in one stage: the folder, and what turned out to be wrong."""

    def __init__(self, stage, what):
        self.stage = stage
        self.what = f"{stage.name}, {what}"
        self.folder = stage.trial(re.sub(r"\W+", "_", what))
        self.out = os.path.join(self.folder, "out")
        self.wrong = []

    def fault(self, below, calls, number, do):
        """The environment that injects it into a call below a folder of the trial."""
        folder = os.path.normpath(os.path.join(self.folder, below))
        return environment(under=folder, calls=calls, at=number, do=do, log=self.folder + ".calls")

    def reached(self, number):
        """Whether the interposer came to that call."""
        return len(read(self.folder + ".calls").splitlines()) >= number

    def expect(self, right, fault):
        if not right:
            self.wrong.append(f"{self.what}: {fault}")

    def expect_result(self):
        now, new = tree(self.out), self.stage.new
        self.expect(now == new, "another result: " + ", ".join(sorted(name for name in set(now) | set(new)
                                                                       if now.get(name) != new.get(name))))

    def expect_end(self, code, said, reasons, place="", codes=(FILE_FAILURE,)):
        """One of the codes, a reason and the place in an error, of bad input in all; or 0, and then everything is as it should be."""
        if code == DONE:
            self.expect_result()
            return
        self.expect(code in codes, f"ended with {code}: {said.strip()[-300:]}")
        errors = [line for line in said.splitlines() if line.startswith("grouser: error: ")]
        self.expect(len(errors) == 1 or (code == BAD_INPUT and errors), f"printed {len(errors)} errors: {said.strip()[-300:]}")
        self.expect(all(place in error and any(reason in error for reason in reasons) for error in errors), f"gave no reason: {errors}")

    def close(self, struck, whole=True):
        """Looks at what is left, and at what the next command makes of it."""
        if whole:
            self.wrong += [f"{self.what}: {fault}" for fault in self.stage.torn(self.folder)]
        self.wrong += [f"{self.what}: {fault}" for fault in self.stage.recover(self.folder)]
        shutil.rmtree(self.folder)
        return Count(int(struck), 1, wrong=["; ".join(self.wrong[:4])] if self.wrong else [])


def refused_call(stage, number, error, lasting):
    """The disk refuses a call, once or from there on."""
    trial = Trial(stage, f"{errno.errorcode[error]}{' from' if lasting else ' at'} call {number}")
    done = run(stage.arguments, trial.folder, trial.fault(".", CHANGES, number, f"{error}{'+' if lasting else ''}"))
    trial.expect_end(done.returncode, done.stderr, [os.strerror(error)])
    return trial.close(trial.reached(number))


def unreadable_input(stage, number):
    """A disk that breaks while an input is read: never a result from a part of it."""
    trial = Trial(stage, f"EIO at look {number}")
    done = run(stage.arguments, trial.folder, trial.fault(".", LOOKS, number, errno.EIO))
    trial.expect_end(done.returncode, done.stderr, ["cannot read", "cannot open", os.strerror(errno.EIO)],
                     codes=(FILE_FAILURE, BAD_INPUT))
    return trial.close(trial.reached(number))


def vanished_input(stage, number, path):
    """An input, or the folder of all, is taken away before an input is opened, and put back when the command has ended."""
    trial = Trial(stage, f"{path} taken away at open {number}")
    there, away = os.path.join(trial.folder, path), os.path.join(trial.folder, "away")
    code, said, stopped = stopped_amid(trial, trial.fault(INPUTS, "o", number, "stop"), lambda: os.rename(there, away))
    trial.expect(stopped, "was not stopped")
    trial.expect_end(code, said, [GONE], path, (FILE_FAILURE, BAD_INPUT))
    trial.expect(not os.path.exists(there), "made what was taken away")
    os.rename(away, there)
    return trial.close(code != DONE)


def limited(stage, what, limit, value, reasons):
    """Under a limit of the system for the process."""
    trial = Trial(stage, f"{what} of {value}")
    done = subprocess.run([COMMAND, *stage.arguments], cwd=trial.folder, capture_output=True, text=True,
                          timeout=injection.PATIENCE, errors="replace",
                          preexec_fn=lambda: resource.setrlimit(limit, (value, value)))
    trial.expect_end(done.returncode, done.stderr, reasons)
    return trial.close(done.returncode != DONE)


def signalled(stage, with_signal, delay):
    """Asked to stop after it began to read: it says so once, ends with 130, and keeps what is whole; or it was done already."""
    trial = Trial(stage, f"{signal.Signals(with_signal).name} after {delay:.3f} s")
    process = injection.start(stage.arguments, trial.folder, trial.fault(INPUTS, "o", 1, "stop"), stderr=subprocess.PIPE, text=True)
    trial.expect(stopped_process(process) == process.pid, "did not reach its first input")
    process.send_signal(signal.SIGCONT)
    time.sleep(delay)
    process.send_signal(with_signal)
    _, said = process.communicate(timeout=injection.PATIENCE)
    trial.expect(process.returncode in (DONE, INTERRUPTED), f"ended with {process.returncode}: {said[-300:]}")
    told = sum("interrupted" in line for line in said.splitlines())
    trial.expect(told == (process.returncode == INTERRUPTED), f"said {told} times that it was interrupted: {said[-300:]}")
    if process.returncode == DONE:
        trial.expect_result()
    return trial.close(process.returncode == INTERRUPTED)


def closed_stdout(stage):
    """`| head -1`: what was made stands, and the exit code tells that the result found nobody."""
    trial = Trial(stage, "stdout closed")
    ours, theirs = os.pipe()
    os.close(ours)
    done = subprocess.run([COMMAND, *map(str, stage.arguments)], cwd=trial.folder, stdout=theirs,
                          stderr=subprocess.PIPE, text=True, timeout=injection.PATIENCE)
    os.close(theirs)
    trial.expect(done.returncode == FILE_FAILURE, f"ended with {done.returncode}: {done.stderr[-300:]}")
    trial.expect("stdout: expected to write the result, found it closed or full" in done.stderr, done.stderr[-300:])
    trial.expect_result()
    return trial.close(True)


def closed_stderr(stage):
    """Nobody reads the progress: that is no reason to stop."""
    trial = Trial(stage, "stderr closed")
    ours, theirs = os.pipe()
    os.close(ours)
    done = subprocess.run([COMMAND, *map(str, stage.arguments)], cwd=trial.folder, stdout=subprocess.DEVNULL,
                          stderr=theirs, timeout=injection.PATIENCE)
    os.close(theirs)
    trial.expect(done.returncode == DONE, f"ended with {done.returncode}")
    trial.expect_result()
    return trial.close(True)


def state_of(process):
    """Of /proc: R, S, T for stopped, Z; empty when there is none."""
    try:
        with open(f"/proc/{process}/stat", encoding="utf-8") as file:
            return file.read().rsplit(")", 1)[1].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return ""


def stopped_process(process):
    """The number of what the interposer stopped, the command or its child; none when the command ended before."""
    give_up = time.monotonic() + injection.PATIENCE
    while time.monotonic() < give_up and process.poll() is None:
        for each in (process.pid, *children_of(process.pid)):
            if state_of(each) == "T":
                return each
        time.sleep(0.01)
    return None


def stopped_amid(trial, env, meanwhile):
    """Does something while the trial's command stands still: its exit code, what it said, and whether it was stopped."""
    process = injection.start(trial.stage.arguments, trial.folder, env, stderr=subprocess.PIPE, text=True)
    stopped = stopped_process(process)
    if stopped is not None:
        meanwhile()
        os.kill(stopped, signal.SIGCONT)
    _, said = process.communicate(timeout=injection.PATIENCE)
    return process.returncode, said, stopped is not None


def vanished_output(stage, number):
    """The output folder is removed while the command writes into it: it says so, unless its whole result stood there already."""
    trial, stood = Trial(stage, f"output removed at call {number}"), []

    def remove():
        try:
            stood.append(stage.new.items() <= tree(trial.out).items())
        except (OSError, ValueError):  # half a file
            stood.append(False)
        shutil.rmtree(trial.out, ignore_errors=True)

    code, said, stopped = stopped_amid(trial, trial.fault(".", CHANGES, number, "stop"), remove)
    if code != DONE or stood != [True]:
        trial.expect_end(code, said, [GONE])
    return trial.close(stopped, whole=False)


def folder_in_place_of(stage, name):
    """A folder bears the name of an output file."""
    trial = Trial(stage, f"a folder called {name}")
    taken = os.path.join(trial.out, name)
    if os.path.exists(taken):
        os.remove(taken)
    os.makedirs(os.path.join(taken, "of a user"))
    done = run(stage.arguments, trial.folder)
    trial.expect(done.returncode == FILE_FAILURE, f"ended with {done.returncode}: {done.stderr.strip()[-300:]}")
    trial.expect(os.path.basename(name) in done.stderr, f"does not name it: {done.stderr.strip()[-300:]}")
    trial.expect(os.path.isdir(os.path.join(taken, "of a user")), "took the folder away")
    shutil.rmtree(taken)
    return trial.close(True, whole=False)


def two_at_once(stage):
    """The same command twice in one folder: one result, or one of them is refused."""
    trial = Trial(stage, "two at once")
    pair = [injection.start(stage.arguments, trial.folder, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    ends = [(process.communicate(timeout=injection.PATIENCE)[1], process.returncode) for process in pair]
    trial.expect(DONE in [code for _, code in ends], f"none ended well: {ends}")
    for said, code in ends:
        trial.expect(code == DONE or (code == FILE_FAILURE and "another process is still writing" in said),
                     f"ended with {code}: {said[-300:]}")
    trial.expect_result()
    return trial.close(True)


def backward_clock(stage):
    trial = Trial(stage, "the clock runs backwards")
    done = run(stage.arguments, trial.folder, environment(clock=True))
    trial.expect(done.returncode == DONE, f"ended with {done.returncode}: {done.stderr[-300:]}")
    trial.expect_result()
    return trial.close(True)


def is_pending(process, which):
    with open(f"/proc/{process}/status", encoding="utf-8") as file:
        pending = next((line.split()[1] for line in file if line.startswith("ShdPnd")), "0")
    return int(pending, 16) >> (which - 1) & 1


def stopped_twice(stage):
    """The second Ctrl-C ends at once what the first one asked to stop, unless it was quicker."""
    trial = Trial(stage, "two SIGINT")
    process = injection.start(stage.arguments, trial.folder, trial.fault(INPUTS, "o", 1, "stop"))
    trial.expect(stopped_process(process) == process.pid, "did not reach its first input")
    process.send_signal(signal.SIGINT)  # pending until it goes on
    process.send_signal(signal.SIGCONT)
    while is_pending(process.pid, signal.SIGINT):
        time.sleep(0.001)
    process.send_signal(signal.SIGSTOP)
    time.sleep(0.4)  # two that come closer count as one
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGCONT)
    code = process.wait(injection.PATIENCE)
    trial.expect(code in (-signal.SIGINT, INTERRUPTED, DONE), f"ended with {code}")
    return trial.close(code == -signal.SIGINT)


def interrupted_demo(home):
    """Ctrl-C on a terminal reaches the demo alone, which stops its parts; one line says so."""
    data, wrong = os.path.join(home, "demo_data"), []
    os.mkdir(data)
    process = subprocess.Popen([COMMAND, "demo", "-o", os.path.join(home, "demo"), "--data", short_data(data)],
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    said = ""
    for line in process.stderr:
        said += line
        if "frame " in line:
            break
    process.send_signal(signal.SIGINT)
    said += process.stderr.read()
    if process.wait() != INTERRUPTED or sum("interrupted" in line for line in said.splitlines()) != 1:
        wrong.append(f"demo, SIGINT: ended with {process.returncode}: {said[-500:]}")
    return wrong


def closed_help():
    ours, theirs = os.pipe()
    os.close(ours)
    done = subprocess.run([COMMAND, "--help"], stdout=theirs, stderr=subprocess.PIPE, timeout=injection.PATIENCE)
    os.close(theirs)
    return [] if done.returncode == FILE_FAILURE else [f"--help, stdout closed: ended with {done.returncode}"]


def internal_error(home):
    """A fault of the program's own: it says that it is one, and leaves nothing."""
    done = run(["render", "run", "--still", "0.1", "-o", "no_gl"], home, environment(gl=False))
    said = [line for line in done.stderr.splitlines() if line.startswith("grouser: error: internal error: ")]
    right = done.returncode == INTERNAL_ERROR and len(said) == 1 and "please report it" in said[0]
    left = injection.tree(os.path.join(home, "no_gl"))
    return [] if right and not left else [f"no GL context: ended with {done.returncode}: {done.stderr[-300:]}; left {left}"]


def await_state(process, states):
    give_up = time.monotonic() + injection.PATIENCE
    while state_of(process) not in states and time.monotonic() < give_up:
        time.sleep(0.01)
    return state_of(process) in states


def while_surveyed(home):
    """A command that waits for the child that surveys its run.h5, and that child, stopped at a read."""
    for number in range(1, 50):
        process = injection.start(["render", "run", "--frames", "-o", "surveyed", *injection.PICTURE], home,
                                  environment(under=os.path.join(home, "run", "run.h5"), calls=LOOKS, at=number, do="stop"),
                                  stderr=subprocess.PIPE, text=True, start_new_session=True)
        stopped = stopped_process(process)
        if stopped not in (None, process.pid):
            return process, stopped
        process.kill()
        process.communicate()
    raise AssertionError("expected a child that reads run.h5, found none")


def killed_while_surveying(home):
    """The child that reads HDF5 ends with its parent: it would keep the lock of the run."""
    process, child = while_surveyed(home)
    process.kill()
    process.communicate()
    if await_state(child, ("", "Z")):
        return []
    os.kill(child, signal.SIGKILL)
    return ["killed while run.h5 was surveyed: its child went on"]


def interrupted_while_surveying(home):
    """Ctrl-C on a terminal reaches parent and child: the parent answers it, and nothing is said of the file."""
    process, child = while_surveyed(home)
    os.killpg(process.pid, signal.SIGINT)
    os.kill(child, signal.SIGCONT)
    _, said = process.communicate(timeout=injection.PATIENCE)
    right = process.returncode == INTERRUPTED and sum("error" in line for line in said.splitlines()) == 1
    return [] if right and await_state(child, ("",)) else [
        f"SIGINT while run.h5 was surveyed: ended with {process.returncode}: {said[-300:]}"]


MEMORY = ["memory", "allocat", "Cannot allocate", "Resource temporarily unavailable"]


@functools.cache
def least_memory():
    """Kilobytes of addresses without which the program's libraries are not even loaded."""
    short, enough = 0, 10 << 20
    while enough - short > 64:
        size = (short + enough) // 2
        done = subprocess.run([COMMAND, "--version"], capture_output=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size << 10, size << 10)))
        short, enough = (short, size) if done.returncode == DONE else (size, enough)
    return enough


def trials_of(stage, amount, chance):
    """Name of the fault -> functions that try it."""
    measured = Measured(stage)

    def several(count, function, *rest):
        return [lambda n=n: function(stage, n, *rest) for n in spread(count, amount, chance)]

    def stops(with_signal):
        return [lambda d=chance.uniform(0.0, 0.6 * stage.duration): signalled(stage, with_signal, d) for _ in range((amount + 1) // 2)]

    outputs = sorted(name for name in stage.new if not injection.is_temporary(name) and name != "checkpoint")
    shares = [0.9 * (part + chance.random()) / amount for part in range(amount)]
    # run.h5 is looked at by processes of its own before it is read: each must say that it is gone.
    opens = sorted({*spread(len(measured.opened), amount, chance),
                    *(number for number, path in enumerate(measured.opened, 1) if path.endswith("run.h5"))})
    memories = [least_memory() + round(share * (measured.peak - least_memory())) for share in shares]
    return {
        "a full disk, from a call on": several(measured.changes, refused_call, errno.ENOSPC, True),
        "a full disk, at one call": several(measured.changes, refused_call, errno.ENOSPC, False),
        "a read-only folder": [lambda: refused_call(stage, 1, errno.EROFS, True)],
        "a disk that refuses a call with EIO": several(measured.changes, refused_call, errno.EIO, False),
        "a disk that breaks while an input is read": several(measured.looks, unreadable_input),
        "an input taken away meanwhile":
            [lambda n=n: vanished_input(stage, n, measured.opened[n - 1]) for n in opens],
        "the folder of all inputs taken away meanwhile": several(len(measured.opened), vanished_input, INPUTS),
        "a limit on the size of files":
            [lambda n=n: limited(stage, "a file size limit", resource.RLIMIT_FSIZE, n, [os.strerror(errno.EFBIG)])
             for n in (0, measured.largest // 2, 1000)[:amount]],
        "too little memory":
            [lambda n=n: limited(stage, "memory", resource.RLIMIT_AS, n << 10, MEMORY) for n in memories],
        "SIGINT": stops(signal.SIGINT),
        "SIGTERM": stops(signal.SIGTERM),
        "SIGHUP": stops(signal.SIGHUP),
        "a second Ctrl-C": [lambda: stopped_twice(stage)],
        "stdout closed": [lambda: closed_stdout(stage)],
        "stderr closed": [lambda: closed_stderr(stage)],
        "the output folder removed meanwhile": several(measured.changes, vanished_output),
        "a folder in place of an output file":
            [lambda name=name: folder_in_place_of(stage, name) for name in outputs[:amount]],
        "two processes at once": [lambda: two_at_once(stage)],
        "a clock that runs backwards": [lambda: backward_clock(stage)],
    }


ALONE = {"the demo interrupted": interrupted_demo, "--help into a closed pipe": lambda home: closed_help(),
         "a fault of the program's own": internal_error, "SIGKILL while run.h5 is surveyed": killed_while_surveying,
         "SIGINT while run.h5 is surveyed": interrupted_while_surveying}


def row(what, count):
    """Faults that struck; at least half of those tried must, or the row says nothing."""
    if 2 * count.struck < count.tried:
        count.wrong.append(f"{what}: expected half of {count.tried} faults to strike, {count.struck} did")
    told(count.wrong)
    return {"what": what, "count": count.struck, "result": f"struck of {count.tried} tried, {len(count.wrong)} failures"}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--thorough", action="store_true", help="the long form")
    parser.add_argument("--only", metavar="STAGE", help="one stage of the pipeline")
    parser.add_argument("--fault", metavar="NAME", help="one kind of fault")
    parser.add_argument("-o", metavar="FILE.json", dest="output")
    options = parser.parse_args()
    amount = 4 if options.thorough else 1
    turns = 5  # the short form tries every fault in two of ten stages
    if signal.getsignal(signal.SIGHUP) == signal.SIG_IGN:  # under nohup: what is started here must not ignore it, too
        signal.signal(signal.SIGHUP, lambda *_: None)
    counts = {}  # of each fault
    with tempfile.TemporaryDirectory() as home, ThreadPoolExecutor(2) as workers:
        made = os.path.join(home, "made")
        os.mkdir(made)
        for place, stage in enumerate(stages(made)):
            if options.only not in (None, stage.name):
                continue
            stage.prepare(home)
            own_inputs(stage, made)
            chance = seeded(f"{SEED} faults {stage.name}")
            print(stage.name, file=sys.stderr, flush=True)
            kinds = {name: [workers.submit(trial) for trial in trials]
                     for turn, (name, trials) in enumerate(trials_of(stage, amount, chance).items())
                     if options.fault == name or (options.fault is None
                                                  and (options.thorough or turn % turns == place % turns))}
            for name, jobs in kinds.items():
                counts[name] = sum((job.result() for job in jobs), counts.get(name, Count()))
            shutil.rmtree(stage.home)
        if options.only is None and options.fault is None:
            counts |= {name: Count(1, 1, wrong=fault(made)) for name, fault in ALONE.items()}
    rows = [row(name, count) for name, count in counts.items()]
    failures = [fault for count in counts.values() for fault in count.wrong]
    notes = ["Counted are the faults that struck: the call was reached, the command was stopped or ended with an error; of each kind at "
             "least half of those tried do. Behind each: exit code and message are looked at, every file is the old one or the new one, "
             "and the same command without the fault gives the bytes that it always gives."]
    sys.exit(finish("faults", "Faults injected", rows, notes, failures, options.output))


if __name__ == "__main__":
    main()
