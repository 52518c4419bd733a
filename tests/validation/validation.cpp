// grouser_validation [-o FILE] [--check FILE] [CHAPTER...]: computes every comparison of the named chapters (all
// without a name) and prints them. -o writes the document; --check fails where its rows and limits are not the ones
// computed.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "tests/validation/chapters.h"

namespace {

using namespace grouser::validation;

struct Family {
  const char* name;  ///< on the command line and in ctest
  const char* title;
  void (*add)(Chapter&);
};
constexpr Family k_families[] = {
    {"trees", "Rigid-body trees", add_trees},
    {"integrator", "Integrator", add_integrator},
    {"chains", "Chains of links", add_chains},
    {"bushings", "Bushings", add_bushings},
    {"contacts", "Contacts", add_contacts},
    {"suspension", "Suspension", add_suspension},
    {"vehicle_rest", "The vehicle at rest", add_vehicle_rest},
    {"vehicle_modes", "Heave and pitch of the vehicle", add_vehicle_modes},
    {"vehicle_track", "The track on the vehicle", add_vehicle_track},
    {"vehicle_drive", "Straight driving", add_vehicle_drive},
    {"vehicle_turn", "Turning", add_vehicle_turn},
    {"vehicle_slope", "On a slope", add_vehicle_slope},
};

struct Options {
  std::string output, check;
  std::vector<Family> families;
};

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const bool has_value = i + 1 < argc;
    if (std::strcmp(argv[i], "-o") == 0 && has_value) {
      options.output = argv[++i];
    } else if (std::strcmp(argv[i], "--check") == 0 && has_value) {
      options.check = argv[++i];
    } else {
      const auto* family = std::find_if(std::begin(k_families), std::end(k_families),
                                        [&](const Family& f) { return std::strcmp(f.name, argv[i]) == 0; });
      if (family == std::end(k_families)) throw std::runtime_error(fmt::format("no chapter `{}`", argv[i]));
      options.families.push_back(*family);
    }
  }
  if (options.families.empty()) options.families.assign(std::begin(k_families), std::end(k_families));
  return options;
}

/// The preamble, then every chapter that was computed just now or stood in the document before.
std::string document_of(const std::vector<Chapter>& computed, const std::string& before) {
  std::string text = R"(# Validation

What the simulator computes, beside what is known from elsewhere: closed forms, published numbers, independent solvers. Every
measured number was computed when this page was made; nothing is tuned to a row.

- An error is absolute, in the row's unit, or relative (`%`, `rel.`) where its limit says so. The limit names its reason.
- A vector or a curve stands with its worst entry.
- Make it again, after `./test.sh` (`./demo.sh` configures the same folder without tests):
  `cmake --build build/release --target grouser_validation && build/release/grouser_validation -o docs/validation.md`.
  `ctest --test-dir build/release -R validation` computes all rows anew and fails where one is out of its limit, or where this page lists other rows or
  limits.
)";
  for (const Family& family : k_families) {
    const auto fresh = std::find_if(computed.begin(), computed.end(),
                                    [&](const Chapter& chapter) { return chapter.title() == family.title; });
    const std::string chapter = fresh != computed.end() ? fresh->text() : chapter_in(before, family.title);
    if (!chapter.empty()) text += "\n" + chapter;
  }
  return text;
}

/// How the document's list of rows differs from what was computed; empty where it does not.
std::vector<std::string> stale_rows(const std::string& document, const std::vector<Chapter>& chapters) {
  std::vector<std::string> findings;
  for (const Chapter& chapter : chapters) {
    const std::vector<std::string> computed = rows_in("\n" + chapter.text(), chapter.title());
    const std::vector<std::string> listed = rows_in(document, chapter.title());
    for (const std::string& row : computed) {
      if (std::find(listed.begin(), listed.end(), row) == listed.end())
        findings.push_back(chapter.title() + ": not in the document: " + row);
    }
    for (const std::string& row : listed) {
      if (std::find(computed.begin(), computed.end(), row) == computed.end())
        findings.push_back(chapter.title() + ": in the document, but not computed: " + row);
    }
  }
  std::istringstream lines(document);
  for (std::string line; std::getline(lines, line);) {
    const bool known = std::any_of(std::begin(k_families), std::end(k_families),
                                   [&](const Family& family) { return line == "## " + std::string(family.title); });
    if (line.starts_with("## ") && !known) findings.push_back("in the document, but no chapter: " + line);
  }
  return findings;
}

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

int validate(const Options& options) {
  std::vector<Chapter> chapters;
  std::vector<std::string> findings;
  for (const Family& family : options.families) {
    chapters.emplace_back(family.title);
    family.add(chapters.back());
    for (const std::string& failure : chapters.back().failures()) findings.push_back("out of its limit: " + failure);
  }
  if (!options.check.empty()) {
    for (const std::string& stale : stale_rows(read_text(options.check), chapters)) findings.push_back(stale);
  }
  if (options.output.empty()) {
    for (const Chapter& chapter : chapters) std::printf("%s\n", chapter.text().c_str());
  } else {
    const bool exists = std::filesystem::exists(options.output);
    const std::string document = document_of(chapters, exists ? read_text(options.output) : "");
    std::ofstream file(options.output, std::ios::binary);
    if (!(file << document).flush()) throw std::runtime_error("cannot write " + options.output);
  }
  for (const std::string& finding : findings) std::fprintf(stderr, "%s\n", finding.c_str());
  return findings.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return validate(read_options(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "grouser_validation: %s\n", error.what());
    return 2;
  }
}
