"""Every command of README.md works: its `sh` blocks run one after the other in one folder, as a reader would."""

import os
import re
import subprocess
import tempfile
import unittest

from command import COMMAND, SOURCE_DIR, SHORT_RUN

# Scripts that install, build and run everything have their own place in continuous integration.
NOT_HERE = ("./demo.sh", "./test.sh")


def commands():
    """(line number, command) of each line of the fenced `sh` blocks."""
    inside = False
    with open(os.path.join(SOURCE_DIR, "README.md"), encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            if line.startswith("```"):
                inside = line.strip() == "```sh"
            elif inside and line.strip() and not line.startswith("#"):
                yield number, line.strip()


def shortened(command):
    """The same command on a fifth of a second, small pictures: the reader's takes minutes."""
    if re.match(r"grouser simulate ", command):
        command += " " + " ".join(SHORT_RUN)
    if re.match(r"grouser render ", command):
        command += " --size 320x180 --fps 10"
        command = re.sub(r"--still [0-9.]+", "--still 0.1", command)
    return command


class Readme(unittest.TestCase):
    def test_every_command_works_in_its_order(self):
        ran = 0
        with tempfile.TemporaryDirectory() as folder:
            for name in ("test_data", "docs"):
                os.symlink(os.path.join(SOURCE_DIR, name), os.path.join(folder, name))
            environment = dict(os.environ, PATH=os.path.dirname(COMMAND) + os.pathsep + os.environ["PATH"])
            for number, command in commands():
                if command.startswith(NOT_HERE) or command.startswith("grouser demo"):
                    continue
                done = subprocess.run(shortened(command), shell=True, cwd=folder, env=environment, capture_output=True,
                                      text=True)
                self.assertEqual(done.returncode, 0, f"README.md line {number}: {command}\n{done.stderr}")
                ran += 1
        self.assertGreaterEqual(ran, 8, "README.md shows each subcommand")


if __name__ == "__main__":
    unittest.main()
