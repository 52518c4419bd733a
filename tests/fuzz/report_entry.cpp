#include <stdexcept>

#include "model/errors.h"
#include "model/provenance.h"
#include "model/run.h"
#include "reports/report.h"
#include "tests/fuzz/entries.h"
#include "tests/support/mock_inputs.h"
#include "tests/support/mock_run.h"
#include "tests/support/temporary_folder.h"

namespace grouser::fuzz {
namespace {

using test::TemporaryFolder;

/// No template holds it, and the corpus is full of it.
constexpr const char* k_canary = "<grouser-canary";

/// A folder whose main file is replaced by the input.
struct Subject {
  Subject(const char* main_file, void (*fill)(const std::filesystem::path&)) : file(folder / main_file) {
    fill(folder.path());
  }
  TemporaryFolder folder;
  std::filesystem::path file;
};

void fill_fit(const std::filesystem::path& folder) { mock::write_fit_folder(folder); }

void fill_run(const std::filesystem::path& folder) {
  mock::write_inputs(folder, {});
  RunWriter(folder / "run.h5", {}, {{"/joints/names", {"left/sprocket"}}}).close();
}

void leave_empty(const std::filesystem::path&) {}

void try_on(const Subject& subject, std::string_view input) {
  std::ofstream(subject.file, std::ios::binary) << input;
  const std::filesystem::path page = subject.folder / "report.html";
  try {
    write_report({subject.folder.path()}, page);
  } catch (const InputError&) {
    return;
  } catch (const FileError&) {
    return;
  }
  if (read_whole(page).find(k_canary) != std::string::npos) {
    throw std::logic_error("the page holds markup of the input");
  }
}

}  // namespace

void report_entry(std::string_view input) {
  static const Subject fit("fit.json", fill_fit), replay("replay.json", leave_empty);
  try_on(input.find("grouser.replay/") == std::string_view::npos ? fit : replay, input);
}

void run_report_entry(std::string_view input) {
  static const Subject run("run.json", fill_run);
  try_on(run, input);
}

}  // namespace grouser::fuzz
