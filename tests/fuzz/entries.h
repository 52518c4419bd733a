#pragma once
#include <filesystem>
#include <string_view>

/// What hostile bytes are fed to: by libFuzzer (a program for each entry) and, input by input of tests/fuzz/corpus, by
/// the ordinary tests. An entry returns when the input was read or refused as the program refuses it; everything else
/// (a signal, another exception, a sanitizer's finding, a broken promise) is a fault of the program.
namespace grouser::fuzz {

/// A file of any kind that `grouser check` reads, by the reader of its format. Lines `#set path=value` before the
/// document are overrides of a scenario.
void json_entry(std::string_view input);
/// A table: of a rig test, of a terrain profile, and with every column read.
void csv_entry(std::string_view input);
/// run.h5: surveyed in this process, where a sanitizer sees all and coverage is counted, though HDF5 may crash it; if
/// nothing is wrong, every dataset with its columns is read, as the program does it.
void hdf5_entry(std::string_view input);
/// fit.json or replay.json of a folder over which a report is written. Throws std::logic_error when the page holds the
/// corpus' canary, an element of no page.
void report_entry(std::string_view input);
/// As report_entry, run.json of a run that recorded nothing: what a run's page tells of its channels is left to
/// tests/reliability/pages.py, for it draws stills, seconds each under sanitizers.
void run_report_entry(std::string_view input);

/// Faults of ours on purpose: tests/reliability/fuzz.py must find them as it would any other. A number that overflows.
void planted_overflow_entry(std::string_view input);
/// A read past the end of a buffer, called by HDF5, in a child for whose end nobody asks.
void planted_child_entry(std::string_view input);

}  // namespace grouser::fuzz
