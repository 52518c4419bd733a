"""Files that HDF5 reads and a run never is, made by h5py from the run.h5 of a run."""

import os
import shutil

import h5py
import numpy


def hostile_hdf5(good, folder):
    """Variants of run.h5 by h5py: name -> words of the message (None: may be read, too)."""
    cases = {}

    def variant(name, words, change):
        path = os.path.join(folder, name)
        shutil.copyfile(good, path)
        with h5py.File(path, "r+") as file:
            change(file)
        cases[name] = words

    def replace(path, **options):
        def change(file):
            del file[path]
            file.create_dataset(path, **options)
        return change

    def fill(path, value):
        def change(file):
            file[path][...] = value
        return change

    def drop(path):
        return lambda file: file.__delitem__(path)

    with h5py.File(good, "r") as file:
        rows = file["time"].shape[0]
    variant("no_time.h5", None, drop("time"))
    variant("no_names.h5", "the names of the joints", drop("joints/names"))
    variant("no_tracks.h5", None, drop("tracks"))
    variant("billion_rows.h5", "claims", replace("time", shape=(10**9,), maxshape=(None,), dtype="f8", chunks=(1024,)))
    variant("vast_chunk.h5", "chunks above", replace("time", shape=(10**9,), dtype="f8", chunks=(10**8,)))
    variant("whole_numbers.h5", "32- or 64-bit numbers", replace("time", data=numpy.arange(rows)))
    variant("big_endian.h5", "32- or 64-bit numbers", replace("time", data=numpy.arange(rows, dtype=">f8")))
    variant("texts_for_numbers.h5", None, replace("time", data=["a"] * rows, dtype=h5py.string_dtype()))
    variant("numbers_for_texts.h5", "no list of texts", replace("joints/names", data=numpy.arange(3.0)))
    variant("scalar.h5", "dimensions", replace("time", data=1.0))
    variant("wrong_width.h5", "rows of 4 values", replace("chassis/orientation", data=numpy.zeros((rows, 3))))
    variant("fewer_rows.h5", None, replace("chassis/position", data=numpy.zeros((1, 3))))
    variant("time_nan.h5", "times that rise", fill("time", numpy.nan))
    variant("time_backwards.h5", "times that rise", lambda file: file["time"].write_direct(numpy.arange(rows, 0.0, -1.0)))
    places = ("chassis/position", "chassis/orientation", "tracks/left/link_position", "energy/input")
    variant("nan_channels.h5", None, lambda file: [fill(path, numpy.nan)(file) for path in places])
    variant("infinite_forces.h5", None, fill("tracks/left/bushing_force", numpy.inf))
    variant("soft_link.h5", "link to another place", lambda file: file.__setitem__("more", h5py.SoftLink("/time")))
    variant("other_file.h5", "link to another place", lambda file: file.__setitem__("more", h5py.ExternalLink("/etc/passwd", "/")))
    variant("external_data.h5", "another file",
            lambda file: file.create_dataset("stolen", (10,), "f8", external=[("/etc/passwd", 0, 80)]))
    variant("compound.h5", "32- or 64-bit numbers",
            lambda file: file.create_dataset("more", data=numpy.zeros(3, dtype=[("a", "f8")])))
    variant("unit_a_number.h5", "a unit that is no text", lambda file: file["time"].attrs.__setitem__("unit", 3))
    variant("other_filter.h5", "filter", replace("time", data=numpy.arange(float(rows)), chunks=(rows,), compression="lzf"))
    bomb = numpy.zeros(4 << 20)
    variant("bomb.h5", None, lambda file: file.create_dataset("more", data=bomb, chunks=(4 << 20,), compression="gzip"))
    variant("cyclic_groups.h5", None, lambda file: file.__setitem__("tracks/again", file["/"]))
    path = os.path.join(folder, "of_another_program.h5")
    with h5py.File(path, "w") as file:
        file["entry/data"] = numpy.arange(10)
    cases["of_another_program.h5"] = "32- or 64-bit numbers"
    with open(os.path.join(folder, "text.h5"), "w", encoding="utf-8") as file:
        file.write("no HDF5")
    cases["text.h5"] = "no HDF5 file"
    with open(os.path.join(folder, "empty.h5"), "w", encoding="utf-8"):
        pass
    cases["empty.h5"] = "no HDF5 file"
    return cases
