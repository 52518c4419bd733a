"""Disks that fill up or break, folders that are read-only or vanish, closed pipes, signals, too little memory, two
processes at once and a clock that runs backwards: a clear message, the right exit code, nothing lost."""

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
from injection import COMMAND, children_of, environment, finish, read, run, seeded, short_data, spread, stages, told, tree
from kills import CHANGES, SEED

DONE, FILE_FAILURE, INTERNAL_ERROR, INTERRUPTED = 0, 5, 70, 130


class Trial:
    """One fault in one stage: the folder, and what turned out to be wrong."""

    def __init__(self, stage, what):
        self.stage = stage
        self.what = f"{stage.name}, {what}"
        self.folder = stage.trial(re.sub(r"\W+", "_", what))
        self.wrong = []

    def expect(self, right, fault):
        if not right:
            self.wrong.append(f"{self.what}: {fault}")

    def expect_end(self, done, reasons):
        """Exit code 5 with one of the reasons on stderr; or 0, and then everything is as it should be."""
        if done.returncode == DONE:
            now = tree(os.path.join(self.folder, "out"))
            self.expect(now == self.stage.new, "ended with 0, and with another result: "
                        + ", ".join(sorted(name for name in set(now) | set(self.stage.new)
                                           if now.get(name) != self.stage.new.get(name))))
            return
        self.expect(done.returncode == FILE_FAILURE, f"ended with {done.returncode}: {done.stderr.strip()[-300:]}")
        errors = [line for line in done.stderr.splitlines() if line.startswith("grouser: error: ")]
        self.expect(len(errors) == 1, f"printed {len(errors)} errors: {done.stderr.strip()[-300:]}")
        self.expect(any(reason in error for error in errors for reason in reasons), f"gave no reason: {errors}")

    def close(self, whole=True):
        """Looks at what is left, and at what the next command makes of it."""
        if whole:
            self.wrong += [f"{self.what}: {fault}" for fault in self.stage.torn(self.folder)]
        self.wrong += [f"{self.what}: {fault}" for fault in self.stage.recover(self.folder)]
        shutil.rmtree(self.folder)
        return ["; ".join(self.wrong[:4])] if self.wrong else []


def refused_call(stage, number, error, lasting):
    """The disk refuses a call, once or from there on."""
    trial = Trial(stage, f"{errno.errorcode[error]}{' from' if lasting else ' at'} call {number}")
    done = run(stage.arguments, trial.folder,
               environment(under=trial.folder, calls=CHANGES, at=number, do=f"{error}{'+' if lasting else ''}"))
    trial.expect_end(done, [os.strerror(error)])
    return trial.close()


def unreadable_input(stage, number, home):
    """A disk that breaks while an input is read: never a result from a part of it."""
    trial = Trial(stage, f"EIO at read {number}")
    done = run(stage.arguments, trial.folder, environment(under=home, calls="r", at=number, do=errno.EIO))
    trial.expect_end(done, ["cannot read", "cannot open", os.strerror(errno.EIO)])
    return trial.close()


def limited(stage, what, limit, value, reasons):
    """Under a limit of the system for the process."""
    trial = Trial(stage, f"{what} of {value}")
    done = subprocess.run([COMMAND, *map(str, stage.arguments)], cwd=trial.folder, capture_output=True, text=True,
                          timeout=injection.PATIENCE, errors="replace",
                          preexec_fn=lambda: resource.setrlimit(limit, (value, value)))
    trial.expect_end(done, reasons)
    return trial.close()


def signalled(stage, with_signal, delay):
    """Asked to stop: it says so once, and keeps what is whole."""
    trial = Trial(stage, f"{signal.Signals(with_signal).name} after {delay:.3f} s")
    process = injection.start(stage.arguments, trial.folder, stderr=subprocess.PIPE, text=True)
    time.sleep(delay)
    process.send_signal(with_signal)
    _, said = process.communicate(timeout=injection.PATIENCE)
    early = process.returncode == -with_signal  # before the program had begun
    trial.expect(early or process.returncode in (DONE, INTERRUPTED), f"ended with {process.returncode}: {said[-300:]}")
    told = sum("interrupted" in line for line in said.splitlines())
    trial.expect(told == (process.returncode == INTERRUPTED), f"said {told} times that it was interrupted: {said[-300:]}")
    return trial.close()


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
    trial.expect(tree(os.path.join(trial.folder, "out")) == stage.new, "the result is another one")
    return trial.close()


def closed_stderr(stage):
    """Nobody reads the progress: that is no reason to stop."""
    trial = Trial(stage, "stderr closed")
    ours, theirs = os.pipe()
    os.close(ours)
    done = subprocess.run([COMMAND, *map(str, stage.arguments)], cwd=trial.folder, stdout=subprocess.DEVNULL,
                          stderr=theirs, timeout=injection.PATIENCE)
    os.close(theirs)
    trial.expect(done.returncode == DONE, f"ended with {done.returncode}")
    trial.expect(tree(os.path.join(trial.folder, "out")) == stage.new, "the result is another one")
    return trial.close()


def wait_until_stopped(process):
    """Until the interposer stopped it; False when it ended before."""
    give_up = time.monotonic() + injection.PATIENCE
    while time.monotonic() < give_up and process.poll() is None:
        with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
            if file.read().rsplit(")", 1)[1].split()[0] == "T":
                return True
        time.sleep(0.01)
    return False


def vanished_output(stage, number):
    """The output folder is removed while the command writes into it."""
    trial = Trial(stage, f"output removed at call {number}")
    process = injection.start(stage.arguments, trial.folder,
                              environment(under=trial.folder, calls=CHANGES, at=number, do="stop"),
                              stderr=subprocess.PIPE, text=True)
    if wait_until_stopped(process):
        shutil.rmtree(os.path.join(trial.folder, "out"), ignore_errors=True)
        process.send_signal(signal.SIGCONT)
    _, said = process.communicate(timeout=injection.PATIENCE)
    trial.expect(process.returncode in (DONE, FILE_FAILURE), f"ended with {process.returncode}: {said[-300:]}")
    trial.expect(process.returncode == DONE or os.strerror(errno.ENOENT) in said, f"gave no reason: {said[-300:]}")
    return trial.close(whole=False)


def folder_in_place_of(stage, name):
    """A folder bears the name of an output file."""
    trial = Trial(stage, f"a folder called {name}")
    taken = os.path.join(trial.folder, "out", name)
    if os.path.exists(taken):
        os.remove(taken)
    os.makedirs(os.path.join(taken, "of a user"))
    done = run(stage.arguments, trial.folder)
    trial.expect(done.returncode == FILE_FAILURE, f"ended with {done.returncode}: {done.stderr.strip()[-300:]}")
    trial.expect(os.path.basename(name) in done.stderr, f"does not name it: {done.stderr.strip()[-300:]}")
    trial.expect(os.path.isdir(os.path.join(taken, "of a user")), "took the folder away")
    shutil.rmtree(taken)
    return trial.close(whole=False)


def two_at_once(stage):
    """The same command twice in one folder: one result, or one of them is refused."""
    trial = Trial(stage, "two at once")
    pair = [injection.start(stage.arguments, trial.folder, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    ends = [(process.communicate(timeout=injection.PATIENCE)[1], process.returncode) for process in pair]
    trial.expect(DONE in [code for _, code in ends], f"none ended well: {ends}")
    for said, code in ends:
        trial.expect(code == DONE or (code == FILE_FAILURE and "another process is still writing" in said),
                     f"ended with {code}: {said[-300:]}")
    trial.expect(tree(os.path.join(trial.folder, "out")) == stage.new, "the result is another one")
    return trial.close()


def backward_clock(stage):
    trial = Trial(stage, "the clock runs backwards")
    done = run(stage.arguments, trial.folder, environment(clock=True))
    trial.expect(done.returncode == DONE, f"ended with {done.returncode}: {done.stderr[-300:]}")
    trial.expect(tree(os.path.join(trial.folder, "out")) == stage.new, "the result is another one")
    return trial.close()


def stopped_twice(stage):
    """The second Ctrl-C ends at once what the first one asked to stop."""
    trial = Trial(stage, "two SIGINT")
    process = injection.start(stage.arguments, trial.folder,
                              environment(under=trial.folder, calls=CHANGES, at=1, do="stop"))
    trial.expect(wait_until_stopped(process), "did not reach its first call")
    process.send_signal(signal.SIGINT)  # pending until it goes on
    process.send_signal(signal.SIGCONT)
    time.sleep(0.4)
    process.send_signal(signal.SIGINT)
    code = process.wait(injection.PATIENCE)
    trial.expect(code in (-signal.SIGINT, INTERRUPTED, DONE), f"ended with {code}")
    return trial.close()


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


def state_of(process):
    """Of /proc: R, S, T for stopped, Z; empty when there is none."""
    try:
        with open(f"/proc/{process}/stat", encoding="utf-8") as file:
            return file.read().rsplit(")", 1)[1].split()[0]
    except FileNotFoundError:
        return ""


def await_state(process, states):
    give_up = time.monotonic() + injection.PATIENCE
    while state_of(process) not in states and time.monotonic() < give_up:
        time.sleep(0.01)
    return state_of(process) in states


def while_surveyed(home):
    """A command that waits for the child that surveys its run.h5, and that child, stopped at a read."""
    for number in range(1, 50):
        process = injection.start(["render", "run", "--frames", "-o", "surveyed", *injection.PICTURE], home,
                                  environment(under=os.path.join(home, "run", "run.h5"), calls="r", at=number, do="stop"),
                                  stderr=subprocess.PIPE, text=True, start_new_session=True)
        while process.poll() is None and state_of(process.pid) != "T":
            stopped = [child for child in children_of(process.pid) if state_of(child) == "T"]
            if stopped:
                return process, stopped[0]
            time.sleep(0.01)
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


def count_reads(stage, home):
    log, folder = os.path.join(stage.home, "reads"), stage.trial("reads_counted")
    run(stage.arguments, folder, environment(under=home, calls="r", log=log))
    shutil.rmtree(folder)
    return len(read(log).splitlines())


@functools.cache
def least_memory():
    """Megabytes of addresses without which the program's libraries are not even loaded."""
    return next(size for size in range(100, 10000, 20)
                if subprocess.run([COMMAND, "--version"], capture_output=True,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size << 20, size << 20))
                                  ).returncode == DONE)


def trials_of(stage, home, amount, chance):
    """Name of the fault -> functions that try it."""
    calls, reads = len(stage.count_calls(CHANGES)), count_reads(stage, home)

    def several(function, *rest):
        return [lambda n=n: function(stage, n, *rest) for n in spread(calls, amount, chance)]

    outputs = sorted(name for name in stage.new if not injection.is_temporary(name) and name != "checkpoint")
    signals = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
    delays = [(chance.choice(signals), chance.uniform(0.05, stage.duration)) for _ in range(amount)]
    megabytes = [least_memory() + chance.randrange(8, 400) for _ in range(amount)]
    return {
        "a full disk, from a call on": several(refused_call, errno.ENOSPC, True),
        "a full disk, at one call": several(refused_call, errno.ENOSPC, False),
        "a read-only folder": [lambda: refused_call(stage, 1, errno.EROFS, True)],
        "a disk that refuses a call with EIO": several(refused_call, errno.EIO, False),
        "a disk that breaks while an input is read":
            [lambda n=n: unreadable_input(stage, n, home) for n in spread(reads, amount, chance)],
        "a limit on the size of files":
            [(lambda n=n: limited(stage, "a file size limit", resource.RLIMIT_FSIZE, n, [os.strerror(errno.EFBIG)]))
             for n in (0, 1000, 100000)[:amount]],
        "too little memory":
            [lambda n=n: limited(stage, "memory", resource.RLIMIT_AS, n << 20, MEMORY) for n in megabytes],
        "SIGINT, SIGTERM or SIGHUP":
            [(lambda s=s, d=d: signalled(stage, s, d)) for s, d in delays],
        "a second Ctrl-C": [lambda: stopped_twice(stage)],
        "stdout closed": [lambda: closed_stdout(stage)],
        "stderr closed": [lambda: closed_stderr(stage)],
        "the output folder removed meanwhile": several(vanished_output),
        "a folder in place of an output file":
            [(lambda name=name: folder_in_place_of(stage, name)) for name in outputs[:amount]],
        "two processes at once": [lambda: two_at_once(stage)],
        "a clock that runs backwards": [lambda: backward_clock(stage)],
    }


ALONE = {"the demo interrupted": interrupted_demo, "--help into a closed pipe": lambda home: closed_help(),
         "a fault of the program's own": internal_error, "SIGKILL while run.h5 is surveyed": killed_while_surveying,
         "SIGINT while run.h5 is surveyed": interrupted_while_surveying}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--thorough", action="store_true", help="the long form")
    parser.add_argument("--only", metavar="STAGE", help="one stage of the pipeline")
    parser.add_argument("--fault", metavar="NAME", help="one kind of fault")
    parser.add_argument("-o", metavar="FILE.json", dest="output")
    options = parser.parse_args()
    amount = 4 if options.thorough else 1
    turns = 5  # the short form tries every fault in two of ten stages
    counts, failures = {}, []
    with tempfile.TemporaryDirectory() as home, ThreadPoolExecutor(2) as workers:
        for place, stage in enumerate(stages(home)):
            if options.only not in (None, stage.name):
                continue
            stage.prepare(home)
            chance = seeded(f"{SEED} faults {stage.name}")
            print(stage.name, file=sys.stderr, flush=True)
            kinds = {name: [workers.submit(trial) for trial in trials]
                     for turn, (name, trials) in enumerate(trials_of(stage, home, amount, chance).items())
                     if options.fault == name or (options.fault is None
                                                  and (options.thorough or turn % turns == place % turns))}
            for name, jobs in kinds.items():
                wrong = told([fault for job in jobs for fault in job.result()])
                injected, lost = counts.get(name, (0, 0))
                counts[name] = (injected + len(jobs), lost + len(wrong))
                failures += wrong
            shutil.rmtree(stage.home)
        if options.only is None and options.fault is None:
            for name, fault in ALONE.items():
                wrong = told(fault(home))
                counts[name] = (1, len(wrong))
                failures += wrong
    rows = [{"what": name, "count": injected, "result": f"{lost} failures"} for name, (injected, lost) in counts.items()]
    notes = ["Behind each fault: exit code and message are looked at, every file is the old one or the new one, and the "
             "same command without the fault gives the bytes that it always gives."]
    sys.exit(finish("faults", "Faults injected", rows, notes, failures, options.output))


if __name__ == "__main__":
    main()
