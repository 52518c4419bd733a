"""Every command of README.md works: its `sh` blocks run one after the other in one folder, as a reader would."""

import os
import re
import subprocess
import tempfile
import unittest

from command import COMMAND, SHORT_RUN, SOURCE_DIR, run

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


def example_rig():
    """The `json` block that shows a rig file."""
    with open(os.path.join(SOURCE_DIR, "README.md"), encoding="utf-8") as file:
        return re.search(r"```json\n(.*?)```", file.read(), re.DOTALL).group(1)


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

    def test_every_picture_is_drawn_by_the_script(self):
        with open(os.path.join(SOURCE_DIR, "README.md"), encoding="utf-8") as file:
            shown = set(re.findall(r"docs/pictures/(\w+\.png)", file.read()))
        with open(os.path.join(SOURCE_DIR, "docs/pictures/draw.sh"), encoding="utf-8") as file:
            drawn = set(re.findall(r'"\$here/(\w+\.png)"', file.read()))
        self.assertLessEqual(shown, drawn)
        self.assertGreaterEqual(len(shown), 3)

    def test_the_example_of_a_rig_file_is_one(self):
        rig = example_rig()
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "rig.json"), "w", encoding="utf-8") as file:
                file.write(rig)
            for name in re.findall(r'"file": "([^"]+)"', rig):
                with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                    file.write("time_s,lvdt_a_V,load_cell_V\n")
                    file.writelines(f"{0.1 * i:.1f},{0.01 * i:.2f},{0.02 * i:.2f}\n" for i in range(20))
            self.assertIn("2 tests", run("check", os.path.join(folder, "rig.json")).stdout)


if __name__ == "__main__":
    unittest.main()
