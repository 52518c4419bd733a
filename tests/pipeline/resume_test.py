"""A run that was killed or stopped, and resumed, gives the bytes of one that was never stopped."""

import json
import os
import random
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import h5py

from checkpoint import RICH_RUN, memory_of, missing_memory
from command import CLOCK, COMMAND, run

SIMULATE = ["simulate", *RICH_RUN, "-o", "run", "--set", "duration_s=3.1"]  # two checkpoints on the way


def datasets(folder):
    """Name -> (shape, bytes) of everything in run.h5."""
    found = {}

    def keep(name, item):
        if isinstance(item, h5py.Dataset):
            value = item[()]
            found[name] = (item.shape, value.tolist() if value.dtype == object else value.tobytes())

    with h5py.File(os.path.join(folder, "run.h5"), "r") as file:
        file.visititems(keep)
    return found


def summary(folder):
    with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
        return {key: value for key, value in json.load(file).items() if key not in CLOCK}


class Resume(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.whole = os.path.join(cls.temporary.name, "whole")
        os.mkdir(cls.whole)
        started = time.monotonic()
        run(*SIMULATE, cwd=cls.whole)
        cls.patience = 20 * (time.monotonic() - started)  # s; a loaded machine is slower, but not twenty times

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def folder(self, name):
        path = os.path.join(self.temporary.name, name)
        os.mkdir(path)
        return path

    def start(self, folder, *more):
        return subprocess.Popen([COMMAND, *SIMULATE, *more], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def wait_for_checkpoint(self, folder, process):
        give_up = time.monotonic() + self.patience
        while not os.path.exists(os.path.join(folder, "run", "checkpoint")):
            self.assertIsNone(process.poll(), "the run ended before its first checkpoint")
            self.assertLess(time.monotonic(), give_up)
            time.sleep(0.01)

    def stop_at_first_checkpoint(self, folder, with_signal, delay=0.0):
        process = self.start(folder)
        self.wait_for_checkpoint(folder, process)
        time.sleep(delay)
        process.send_signal(with_signal)
        return process.wait()

    def refusal(self, folder, *options):
        done = subprocess.run([COMMAND, *SIMULATE, *options, "--resume"], cwd=folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 3, done.stderr)
        return done.stderr

    def compare(self, folder):
        self.assertEqual(missing_memory(os.path.join(folder, "run", "checkpoint")), [])
        run(*SIMULATE, "--resume", cwd=folder)
        one, two = datasets(os.path.join(self.whole, "run")), datasets(os.path.join(folder, "run"))
        self.assertEqual(set(one), set(two))
        self.assertGreater(len(one), 70)
        self.assertEqual([name for name in one if one[name] != two[name]], [])
        self.assertEqual(summary(os.path.join(self.whole, "run")), summary(os.path.join(folder, "run")))

    def test_a_run_killed_again_and_again_ends_as_one_that_was_not(self):
        folder = self.folder("killed")
        chance = random.Random(4)
        self.assertEqual(self.stop_at_first_checkpoint(folder, signal.SIGKILL, 0.1), -signal.SIGKILL)
        for _ in range(3):  # also while it is still taking up the run
            process = self.start(folder, "--resume")
            time.sleep(chance.uniform(0.0, 0.3))
            process.kill()
            process.wait()
        file, last = (os.path.join(place, "run", "checkpoint") for place in (folder, self.whole))
        self.assertLess(memory_of(file)["time"], memory_of(last)["time"])
        self.compare(folder)
        self.assertEqual(memory_of(file)["all"], memory_of(last)["all"])  # of rubber, ground, integrator and recorder, far behind

    def test_a_checkpoint_stands_every_two_seconds_however_few_the_samples(self):
        folder = self.folder("sparse")
        run(*SIMULATE, "--set", "output.rate_Hz=0.01", cwd=folder)
        for place, least, most in ((self.whole, 2.2, 2.6), (folder, 2.2, 2.3)):  # with its second chunk behind two seconds, or without one
            self.assertTrue(least < memory_of(os.path.join(place, "run", "checkpoint"))["time"] < most)

    def test_an_interrupted_run_goes_on_where_it_stopped(self):
        folder = self.folder("interrupted")
        self.assertEqual(self.stop_at_first_checkpoint(folder, signal.SIGINT), 130)
        done = summary(os.path.join(folder, "run"))
        self.assertEqual(done["status"], "stopped")
        self.assertGreater(done["steps"]["accepted"], 0)
        self.compare(folder)

    def test_what_cannot_be_resumed_is_refused_with_the_reason(self):
        folder = self.folder("refused")
        self.assertIn("expected a checkpoint to go on from, found no such file", self.refusal(folder))
        self.stop_at_first_checkpoint(folder, signal.SIGKILL)
        changed = self.refusal(folder, "--set", "vehicle.left.track.pre_tension_kN=20")
        self.assertIn("checkpoint: vehicle: expected the input that the run was started with, SHA-256 ", changed)
        file = os.path.join(folder, "run", "checkpoint")
        with open(file, "rb") as stream:
            whole = stream.read()
        flipped = bytearray(whole)
        flipped[len(whole) // 2] ^= 1
        for damaged in (whole[: len(whole) // 2], bytes(flipped), whole[:40]):
            with open(file, "wb") as stream:
                stream.write(damaged)
            self.assertIn("cut short or damaged", self.refusal(folder))

    def test_a_run_that_still_goes_on_is_left_alone(self):
        folder = self.folder("running")
        process = self.start(folder)
        self.wait_for_checkpoint(folder, process)
        process.send_signal(signal.SIGSTOP)  # it stays where it is, and alive
        done = subprocess.run([COMMAND, *SIMULATE, "--resume"], cwd=folder, capture_output=True, text=True)
        process.kill()
        process.wait()
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("another process is still writing this run", done.stderr)

    def test_a_run_that_cannot_begin_leaves_the_one_before_it(self):
        folder = self.folder("no_room")
        self.stop_at_first_checkpoint(folder, signal.SIGKILL)

        def no_room():
            resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))

        done = subprocess.run([COMMAND, *SIMULATE, "-q"], cwd=folder, capture_output=True, text=True, preexec_fn=no_room)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("cannot write in run/inputs: File too large", done.stderr)
        self.compare(folder)

    def test_a_run_does_not_write_over_inputs_that_stand_where_it_keeps_its_own(self):
        folder = self.folder("own_inputs")
        shutil.copytree(os.path.join(self.whole, "run", "inputs"), os.path.join(folder, "inputs"))
        scenario = os.path.join(folder, "inputs", "scenario.json")
        with open(scenario, "rb") as file:
            before = file.read()
        done = subprocess.run([COMMAND, "simulate", scenario, "-o", folder, "--set", "duration_s=0.3"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("inputs/scenario.json: expected a name that no input has", done.stderr)
        with open(scenario, "rb") as file:
            self.assertEqual(file.read(), before)

    def test_a_run_does_not_take_the_name_of_its_scenario(self):
        folder = self.folder("own_scenario")
        shutil.copytree(os.path.join(self.whole, "run", "inputs"), os.path.join(folder, "inputs"))
        scenario = os.path.join(folder, "inputs", "run.json")
        os.rename(os.path.join(folder, "inputs", "scenario.json"), scenario)
        with open(scenario, "rb") as file:
            before = file.read()
        done = subprocess.run([COMMAND, "simulate", scenario, "-o", os.path.join(folder, "inputs")], capture_output=True, text=True)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("run.json: expected a name that no input has", done.stderr)
        with open(scenario, "rb") as file:
            self.assertEqual(file.read(), before)

    def test_a_completed_run_is_not_resumed(self):
        self.assertIn("expected a run that was stopped or killed, found completed", self.refusal(self.whole))


if __name__ == "__main__":
    unittest.main()
