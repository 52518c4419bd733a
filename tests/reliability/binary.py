"""The built program: what hardening did to it, what it cannot call, and that nothing it reads leads it out of its folder.

Read from the files with readelf and nm (binutils); run under confine.py, where the kernel ends a program at its first
network call and at its first start of another program."""

import json
import os
import platform
import re
import shutil
import signal
import subprocess
import sys
import tempfile

import h5py

sys.path.insert(0, os.path.join(os.environ["GROUSER_SOURCE_DIR"], "tests", "pipeline"))
from command import COMMAND, DATA, SHORT_RUN  # noqa: E402
from part import main  # noqa: E402

BUILD = os.path.dirname(os.path.abspath(COMMAND))
CONFINE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "confine.py")
ROOMS = ("model", "identification", "simulator", "render", "reports")
NETWORK = """socket connect bind listen accept accept4 send sendto sendmsg recv recvfrom recvmsg getaddrinfo gethostbyname
 getnameinfo inet_pton res_query curl_easy_perform SSL_connect BIO_new_connect avformat_network_init""".split()
PROGRAMS = """system popen posix_spawn posix_spawnp execl execlp execle execv execve execvp execvpe execveat fexecve
 wordexp dlopen""".split()
UNBOUNDED = "gets strcpy strcat sprintf vsprintf mktemp tmpnam tempnam alloca".split()
LIMIT = 255  # bytes in the name of a file, on every file system of Linux


def output_of(*arguments):
    return subprocess.run(arguments, check=True, capture_output=True, text=True).stdout


def own_objects():
    """The object files of cli/ and the libraries' folders, as the build has them."""
    with open(os.path.join(BUILD, "compile_commands.json"), encoding="utf-8") as file:
        commands = json.load(file)
    own = tuple(os.path.join(target, "") for target in
                ("cli/CMakeFiles/grouser.dir", *(f"{room}/CMakeFiles/grouser_{room}.dir" for room in ROOMS)))
    outputs = [re.search(r" -o (\S+\.o)", command["command"])[1] for command in commands]
    return [os.path.join(BUILD, output) for output in outputs if output.startswith(own)]


def hardening(part):
    head, segments = output_of("readelf", "-hW", COMMAND), output_of("readelf", "-lW", COMMAND)
    dynamic, imports = output_of("readelf", "-dW", COMMAND), output_of("nm", "-D", "--undefined-only", COMMAND)
    stack = re.search(r"GNU_STACK.*?0x\S+ 0x\S+ 0x\S+ 0x\S+ 0x\S+ (.{3})", segments)
    checks = {
        "position independent executable": "DYN (" in head and "PIE" in dynamic,
        "relocations read-only, all bound at start (full RELRO)": "GNU_RELRO" in segments and "NOW" in dynamic,
        "stack not executable": stack is not None and "E" not in stack.group(1),
        "no segment both writable and executable": not re.search(r"LOAD.* RWE ", segments),
        "no search path of libraries inside": "RPATH" not in dynamic and "RUNPATH" not in dynamic,
        "checked buffers (_FORTIFY_SOURCE)": re.search(r"__\w+_chk\b", imports.replace("__stack_chk_fail", "")) is not None,
    }
    for what, right in checks.items():
        part.require(right, f"hardening: {what}")
    part.row("hardening read from the program's file", len(checks), "all as asked: " + "; ".join(checks))
    objects = own_objects()
    part.require(len(objects) > 100, f"own objects: expected more than 100 in {BUILD}, found {len(objects)}")
    sanitized = "__asan_init" in imports or "__tsan_init" in imports
    # Pictures and pages that are built in are data without code.
    plain = [os.path.basename(name) for name in objects if not name.endswith(".S.o") and
             not {"IBT", "SHSTK"} <= set(re.findall(r"\w+", output_of("readelf", "-nW", name)))]
    part.require(not plain, f"{len(plain)} objects whose indirect branches are not guarded: {', '.join(plain[:5])}")
    part.require(sum("__stack_chk_fail" in output_of("nm", "-u", name) for name in objects) > 20, "hardly any stack guard")
    part.row("own objects compiled with guarded indirect branches (-fcf-protection)", len(objects), "all")
    return objects, sanitized


def symbols(part, objects):
    forbidden = {*NETWORK, *PROGRAMS, *UNBOUNDED}
    calling, undefined = [], 0
    for name in objects:
        asked = {line.split()[-1] for line in output_of("nm", "-u", name).splitlines()}
        undefined += len(asked)
        calling += [f"{name} calls {symbol}" for symbol in sorted(asked & forbidden)]
    part.require(not calling, "; ".join(calling))
    part.require(undefined > 10 * len(objects), f"own objects: expected more undefined symbols than {undefined}")
    part.row("own objects that ask for a function of the network, a shell, another program, or without bounds",
             len(calling), f"of {len(objects)} objects with {undefined} undefined symbols; {len(forbidden)} functions looked for")
    asked = {line.split()[-1].split("@")[0] for line in output_of("nm", "-D", "--undefined-only", COMMAND).splitlines()}
    found = sorted(asked & {*NETWORK, *PROGRAMS})
    part.require(not found, f"the program imports {', '.join(found)}")
    part.row("network or program-starting functions that the linked program imports", len(found), "none")
    direct = re.findall(r"NEEDED.*\[(.*?)\]", output_of("readelf", "-dW", COMMAND))
    loaded = [line.split()[0] for line in output_of("ldd", COMMAND).splitlines() if "=>" in line]
    part.require(not [name for name in direct if "opencv" in name], "OpenCV is linked again")
    part.row("libraries that the program asks for by name", len(direct), ", ".join(direct))
    part.note(f"With what those libraries ask for in turn, {len(loaded)} are loaded. Some of them can talk to a network "
              "(FFmpeg's file formats bring protocols along), so what the pipeline really calls is watched by the kernel, below.")


class Confined:
    def __init__(self, part, folder):
        self.part, self.folder, self.commands = part, folder, 0
        # The C library looks up who the user is through a local socket: for Ceres' logging where USER is not set, for Mesa's
        # cache of shaders where it is on.
        self.environment = dict(os.environ, USER=os.environ.get("USER") or "user", MESA_SHADER_CACHE_DISABLE="true")

    def run(self, *arguments, code=0):
        done = subprocess.run([sys.executable, CONFINE, COMMAND, *arguments], cwd=self.folder, env=self.environment,
                              capture_output=True, text=True, errors="replace", timeout=600)
        self.commands += 1
        told = "a forbidden call" if done.returncode == -signal.SIGSYS else f"{done.returncode}: {done.stderr[-400:]}"
        self.part.require(done.returncode == code, f"confined: grouser {' '.join(arguments)[:120]} ended with {told}")
        return done


def confinement_bites(part):
    """What confine.py is for, on programs that do try."""
    in_child = ("import os, signal, sys\nif os.fork() == 0: os.execv('/bin/true', ['true'])\n"
                "sys.exit(73 if os.WTERMSIG(os.wait()[1]) == signal.SIGSYS else 0)")
    tries = {"a socket": ("import socket; socket.socket()", -signal.SIGSYS),
             "another program": ("import os; os.execv('/bin/true', ['true'])", -signal.SIGSYS),
             "another program in a child": (in_child, 73)}
    for what, (text, expected) in tries.items():
        done = subprocess.run([sys.executable, CONFINE, sys.executable, "-c", text], capture_output=True, text=True)
        part.require(done.returncode == expected,
                     f"confine.py and {what}: expected code {expected}, found {done.returncode} {done.stderr[-200:]}")
    part.row("forbidden calls that programs made for it do try", len(tries), "each ended by SIGSYS")


def short_demo(folder):
    """test_data with runs of a fifth of a second."""
    os.makedirs(os.path.join(folder, "scenarios"))
    for name in ("rig", "vehicles", "bushings"):
        os.symlink(os.path.join(DATA, name), os.path.join(folder, name))
    for name in ("run_a.json", "run_b.json"):
        with open(os.path.join(DATA, "scenarios", name), encoding="utf-8") as file:
            scenario = dict(json.load(file), duration_s=0.2)
        with open(os.path.join(folder, "scenarios", name), "w", encoding="utf-8") as file:
            json.dump(scenario, file)


def pipeline(part, confined, thorough):
    scenario = os.path.join(DATA, "scenarios/m113.json")
    protocol, bushing = os.path.join(DATA, "rig/protocol/rig.json"), os.path.join(DATA, "bushings/m113.json")
    run = confined.run
    run("check", scenario, protocol, bushing)
    run("rig", protocol, "--bushing", bushing, "-o", "rig")
    run("identify", "rig/rig.json", "-o", "fit")
    run("simulate", scenario, "-o", "run", *SHORT_RUN, "--set", "assembly.settle_time_s=2.6")
    run("render", "run", "--still", "0.1", "--size", "160x90", "-o", "stills")
    run("render", "run", "--film", "film.mp4", "--size", "160x90", "--fps", "10")
    # A name that FFmpeg would take for an address stays the name of a file in a folder.
    os.makedirs(os.path.join(confined.folder, "http:/127.0.0.1:9"))
    run("render", "run", "--film", "http://127.0.0.1:9/film.mp4", "--size", "160x90", "--fps", "10")
    part.require(os.path.exists(os.path.join(confined.folder, "http:/127.0.0.1:9/film.mp4")), "http://... was not a file")
    run("plot", "run", "--figure", "tension", "-o", "tension.svg")
    run("export", "run", "--format", "csv", "-o", "csv")
    run("report", "fit", "run", "-o", "report.html")
    run("report", "run", "--against", "csv/probes_sprocket_torque.csv", "-o", "against.html")
    if thorough:
        short_demo(os.path.join(confined.folder, "data"))
        run("demo", "-o", "demo", "--data", "data")
    part.row("commands run where a network call or another program's start is death", confined.commands, "none tried")


def hostile_names(part, confined):
    """A rig campaign whose tests are called like paths; the virtual rig makes a file for each."""
    names = ["../../escaped", os.path.join(confined.folder, "escaped"), "..", ".", "a/b/c", "~/x", "x\ny", "a\x00b", "$(touch escaped)",
             "`touch escaped`;|&", "-o", "C:\\escaped", "con", "\u202egnp", "n" * 300, "\u00fc" * 200, " ", "rig"]
    folder = os.path.join(confined.folder, "names")
    os.makedirs(os.path.join(folder, "inner"))
    with open(os.path.join(DATA, "rig/protocol/rig.json"), encoding="utf-8") as file:
        rig = json.load(file)
    rig["tests"] = [dict(rig["tests"][1], name=name) for name in names]
    with open(os.path.join(folder, "rig.json"), "w", encoding="utf-8") as file:
        json.dump(rig, file)
    before = tree(confined.folder)
    confined.run("rig", "names/rig.json", "--bushing", os.path.join(DATA, "bushings/m113.json"), "-o", "names/inner/out")
    out = os.path.join(folder, "inner/out")
    outside = {path for path in tree(confined.folder) - before if not os.path.join(confined.folder, path).startswith(out)}
    part.require(not outside, f"files outside the output folder: {sorted(outside)}")
    written = [name for name in os.listdir(out) if name.endswith(".csv")]
    part.require(len(written) == len(names), f"{len(names)} tests made {len(written)} files")
    for name in written:
        part.require(re.fullmatch(r"[A-Za-z0-9_.-]+", name) is not None and len(name) < LIMIT, f"file name {name!r}")
    part.row("tests called like paths, commands, other alphabets or 300 letters long", len(names),
             f"{len(written)} files, all inside the output folder, of plain letters")


def hostile_channels(part, confined):
    """A run whose channels are called like paths and commands; export makes a file for each."""
    names = ["..", "a\nb", "$(touch escaped)", "-o", "<b>", "~", "\u202egnp"]
    shutil.copytree(os.path.join(confined.folder, "run"), os.path.join(confined.folder, "channels"))
    with h5py.File(os.path.join(confined.folder, "channels/run.h5"), "r+") as file:
        for name in names:
            dataset = file.create_dataset(name, data=file["time"][()])
            dataset.attrs["unit"] = "m"
        expected = []
        file.visititems(lambda name, item: expected.append(name) if isinstance(item, h5py.Dataset) else None)
    before = tree(confined.folder)
    confined.run("export", "channels", "--format", "csv", "-o", "inner/csv")
    added = tree(confined.folder) - before
    outside = {path for path in added if not path.startswith("inner")}
    part.require(not outside, f"files outside the output folder: {sorted(outside)}")
    part.require(len(added) == len(expected) + 2, f"{len(expected)} channels made {len(added) - 2} files")
    part.row("channels called like paths or commands, exported", len(names), "all inside the output folder")


# Command with {out} -> what stands in its output folder as a link: what is refused (files in the making, folders), and results, whose place
# is taken.
LINKED = {
    ("simulate", os.path.join(DATA, "scenarios/m113.json"), "-o", "{out}", "--set", "duration_s=0.02", "--set", "assembly.settle_time_s=2.6"):
        (["run.h5.part", "run.json.part", "checkpoint.part", "inputs"], ["run.h5", "run.json", "checkpoint", "inputs/vehicle.json"]),
    ("identify", "rig/rig.json", "-o", "{out}"): (["bushing.json.part", "draws"], ["fit.json", "draws.part"]),
    ("render", "run", "--frames", "--size", "96x54", "--fps", "20", "-o", "{out}"):
        (["frame_000001.png.part", ".frames", ".frames.part", ".frames.lock"], ["frame_000001.png"]),
    ("render", "run", "--film", "film.mp4", "--size", "96x54", "--fps", "20", "-o", "{out}"):
        ([".film.stretches", ".film.partial.mp4", ".film.stretches/stretch_0000.mp4"], ["film.mp4"]),
    ("report", "fit", "-o", "{out}/report.html"): (["report.html.part", "report.json.part"], ["report.html", "report.json"]),
    ("export", "run", "-o", "{out}"): (["time.csv.part"], ["time.csv"]),
}
LINKED_FOLDERS = ("inputs", ".film.stretches", "draws", "draws.part")


def bytes_below(folder):
    """Path -> bytes of every file, not through links."""
    found = {}
    for root, _, names in os.walk(folder):
        for path in (os.path.join(root, name) for name in names):
            with open(path, "rb") as file:
                found[os.path.relpath(path, folder)] = file.read()
    return found


def hostile_link(part, confined, arguments, link, refused):
    """One link in an output folder that may hold an earlier run: to a file or to a folder of a user."""
    outside, out = os.path.join(confined.folder, "outside"), os.path.join(confined.folder, "linked")
    place, target = os.path.join(out, link), os.path.join(outside, "folder")
    os.makedirs(target)
    for name in ("file", "folder/file"):
        with open(os.path.join(outside, name), "w", encoding="utf-8") as file:
            file.write("of a user")
    if arguments[0] == "simulate":
        shutil.copytree(os.path.join(confined.folder, "run"), out)
    os.makedirs(os.path.dirname(place), exist_ok=True)
    if os.path.isdir(place):
        shutil.rmtree(place)
    elif os.path.exists(place):
        os.remove(place)
    os.symlink(target if link in LINKED_FOLDERS else os.path.join(outside, "file"), place)
    theirs, ours = bytes_below(outside), bytes_below(out)
    done = subprocess.run([COMMAND, *(word.format(out=out) for word in arguments)], cwd=confined.folder, capture_output=True, text=True)
    what = f"{arguments[0]} with {link} a link"
    part.require(done.returncode == (5 if refused else 0), f"{what}: ended with {done.returncode}: {done.stderr[-300:]}")
    part.require(bytes_below(outside) == theirs, f"{what}: wrote where the link leads")
    if refused and arguments[0] == "simulate":
        part.require(bytes_below(out) == ours, f"{what}: was refused, and the earlier run is another one")
    for folder in (outside, out):
        shutil.rmtree(folder)


def hostile_links(part, confined):
    """Output folders of another's making: nothing is written, cut or removed where their links lead."""
    tries = [(arguments, link, link in refusals) for arguments, (refusals, results) in LINKED.items() for link in refusals + results]
    for arguments, link, refused in tries:
        hostile_link(part, confined, arguments, link, refused)
    refused = sum(each[2] for each in tries)
    part.row("symbolic links in an output folder, in the place of results and of files in the making", len(tries),
             f"nothing touched where they lead: {refused} refused, the place of {len(tries) - refused} taken")


def tree(folder):
    return {os.path.relpath(os.path.join(root, name), folder)
            for root, folders, files in os.walk(folder) for name in folders + files}


def work(part, thorough):
    objects, sanitized = hardening(part)
    if not sanitized:  # whose runtime is part of the program, and may do anything
        symbols(part, objects)
    if platform.machine() != "x86_64":
        part.note("The confined runs are for x86-64 alone.")
        return
    confinement_bites(part)
    folder = tempfile.mkdtemp(prefix="grouser_binary_")
    try:
        confined = Confined(part, folder)
        pipeline(part, confined, thorough)
        hostile_names(part, confined)
        hostile_channels(part, confined)
        hostile_links(part, confined)
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main("binary", "The program's file, and what it may call", work)
