"""Inputs that no repository holds: too large, too deep, or no plain file."""

import json
import os


def made_at_run_time(folder):
    """What no repository holds: name -> what the message must say."""
    cases = {}

    def case(name, words):
        cases[name] = words
        return os.path.join(folder, name)

    def write(name, content, words):
        with open(case(name, words), "wb") as file:
            file.write(content)

    bushing = b'{"format": "grouser.bushing/1", "name": "b", "axes": {"x": {"stiffness": '
    write("deep.json", b"[" * 1_000_000, "64 levels")
    write("deep_objects.json", b'{"a":' * 500_000, "64 levels")
    write("many_keys.json", b"{" + b",".join(b'"k%d":0' % i for i in range(2_000_000)) + b"}", "10000 keys")
    write("large.json", b" " * (40 << 20), "at most 32 MB")
    write("many_faults.json", bushing + b'{"displacement_mm": [' + b",".join([b'"x"'] * 500_000) + b'], "force_kN": [0]}}}}',
          "at most 200 faults")
    write("long_key.json", bushing + b'{"' + b"k" * 5_000_000 + b'": 0}}}}', "a known key")
    write("many_arrays.json", b"[" + b"[]," * 9_000_000 + b"[]]", "the key format")
    with open(case("sparse.json", "larger than 1 GB"), "wb") as file:
        file.truncate(1 << 40)
    os.mkfifo(case("pipe.json", "is a pipe"))
    os.symlink("loop_b.json", case("loop_a.json", "Too many levels of symbolic links"))
    os.symlink("loop_a.json", case("loop_b.json", "Too many levels of symbolic links"))
    os.symlink("/dev/zero", case("zero.json", "is a device"))
    os.symlink("/proc/self/pagemap", case("endless.json", "larger than 1 GB"))  # a plain file, of no size that is told
    os.mkdir(case("folder", "not a run folder"))
    write("unreadable.json", b"{}", "Permission denied")
    os.chmod(os.path.join(folder, "unreadable.json"), 0)
    header = b"time_s,displacement_mm,force_kN\n"
    tables = {"billion.csv": (header + b"0,0,0\n0.1,1,1\n", "binary data"), "wide.csv": (b"c_mm," * 300_000 + b"\n", "10000 columns"),
              "long_line.csv": (b"1," * 4_000_000, "lines of at most 4 MB"),
              "late_zero.csv": (header + b"0,0,0\n" * 1000 + b"0.1,\x00,1\n", "binary data"),
              "remarks.csv": (b"# nothing\n" * 300_000, "remarks"), "pipe.csv": (None, "is a pipe")}
    for name, (content, words) in tables.items():
        path = os.path.join(folder, name)
        if content is None:
            os.mkfifo(path)
        else:
            with open(path, "wb") as file:
                file.write(content)
                if name == "billion.csv":
                    file.truncate(1 << 36)  # as long as 1e9 rows, and nothing but a hole
        rig = {"format": "grouser.rig/1", "specimen": {"name": "s"},
               "tests": [{"name": "t", "axis": "x", "kind": "cyclic", "frequency_Hz": 1, "file": name}]}
        write(name + ".rig.json", json.dumps(rig).encode(), words)
    return cases
