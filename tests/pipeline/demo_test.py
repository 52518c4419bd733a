"""`grouser demo` on data whose runs are short: every part in its place, and an interruption that leaves nothing running."""

import json
import os
import signal
import subprocess
import tempfile
import time
import unittest

from command import COMMAND, SHORT_S, children_of, run, short_data


def alive(process):
    try:
        with open(f"/proc/{process}/stat", encoding="utf-8") as file:
            return file.read().rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


class Demo(unittest.TestCase):
    def test_every_part_stands_in_its_place(self):
        with tempfile.TemporaryDirectory() as data, tempfile.TemporaryDirectory() as folder:
            done = run("demo", "-o", folder, "--data", short_data(data))
            self.assertEqual(done.stdout.splitlines()[-1], os.path.join(folder, "index.html"))
            expected = ["index.html", "report.html", "report.json"]
            expected += ["identification/" + name for name in ("bushing.json", "fit.json", "report.html", "report.json")]
            expected += ["virtual_rig/" + name for name in ("rig.json", "replay.json", "report.html", "report.json")]
            for part in ("run_a/", "run_b/"):
                expected += [part + name for name in ("run.h5", "run.json", "film.mp4", "report.html", "report.json")]
            for name in expected:
                self.assertGreater(os.path.getsize(os.path.join(folder, name)), 0, name)
            with open(os.path.join(folder, "index.html"), encoding="utf-8") as file:
                self.assertIn("virtual_rig/report.html", file.read())
            stills = [name for name in os.listdir(os.path.join(folder, "run_a")) if name.startswith("still_")]
            self.assertEqual(len(stills), 3)
            with open(os.path.join(folder, "run_a/run.json"), encoding="utf-8") as file:
                self.assertEqual(json.load(file)["simulated_time_s"], SHORT_S)

    def test_a_study_of_stiffness_stands_beside_the_pipeline(self):
        with tempfile.TemporaryDirectory() as data, tempfile.TemporaryDirectory() as folder:
            done = run("demo", "--study", "stiffness", "-o", folder, "--data", short_data(data))
            self.assertEqual(done.stdout.splitlines()[-1], os.path.join(folder, "index.html"))
            with open(os.path.join(folder, "stiffness/report.json"), encoding="utf-8") as file:
                study = json.load(file)["study"]
            self.assertEqual(study["parameter"]["values"], [0.25, 0.5, 1, 2, 4])
            for name in ("x0.25", "x0.5", "x1", "x2", "x4"):
                for part in ("run.json", "run.h5", "report.html"):
                    self.assertTrue(os.path.exists(os.path.join(folder, "stiffness", name, part)), name + "/" + part)
            with open(os.path.join(folder, "index.html"), encoding="utf-8") as file:
                self.assertIn("stiffness/report.html", file.read())

    def test_a_part_that_fails_is_told_also_where_the_caller_ignores_its_children(self):
        with tempfile.TemporaryDirectory() as data, tempfile.TemporaryDirectory() as folder:
            short_data(data)
            with open(os.path.join(data, "scenarios/run_b.json"), "w", encoding="utf-8") as file:
                file.write("{}")
            done = subprocess.run([COMMAND, "demo", "-o", folder, "--data", data], capture_output=True, text=True,
                                  preexec_fn=lambda: signal.signal(signal.SIGCHLD, signal.SIG_IGN))
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertFalse(os.path.exists(os.path.join(folder, "index.html")))

    def test_an_interruption_stops_the_parts_too(self):
        with tempfile.TemporaryDirectory() as folder:
            with subprocess.Popen([COMMAND, "demo", "-o", folder], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                  text=True) as demo:
                for line in demo.stderr:
                    if " of 17 s" in line:
                        break
                children = children_of(demo.pid)
                self.assertEqual(len(children), 2)
                demo.send_signal(signal.SIGINT)
                demo.stderr.read()
            self.assertEqual(demo.returncode, 130)
            time.sleep(0.1)
            self.assertFalse(any(map(alive, children)))
            with open(os.path.join(folder, "run_a/run.json"), encoding="utf-8") as file:
                self.assertEqual(json.load(file)["status"], "stopped")
            self.assertFalse(os.path.exists(os.path.join(folder, "index.html")))


if __name__ == "__main__":
    unittest.main()
