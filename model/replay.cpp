#include "model/replay.h"

#include "model/file_json.h"

namespace grouser {
namespace {

/// Warnings and corrections look alike in files.
template <typename Note>
Json notes_json(const std::vector<Note>& notes) {
  Json list = Json::array();
  for (const Note& note : notes) list.push_back(Json{{"code", note.code}, {"test", note.test}, {"text", note.text}});
  return list;
}

template <typename Note>
std::vector<Note> read_notes(ObjectReader& r, const std::string& key) {
  std::vector<Note> notes;
  r.each(key, 0, [&](ObjectReader& n) { notes.push_back({n.text("code"), n.text_or("test", ""), n.text("text")}); });
  return notes;
}

}  // namespace

ReplayRecord read_replay(const std::filesystem::path& file) {
  ReplayRecord replay;
  read_document(file, k_replay_format, [&](ObjectReader& r) {
    replay.specimen = r.text("specimen");
    replay.bushing = r.text("bushing");
    r.each("tests", 0, [&](ObjectReader& t) { replay.tests.push_back(read_test_fit(t)); });
    replay.warnings = read_notes<FitWarning>(r, "warnings");
    replay.corrections = read_notes<AppliedCorrection>(r, "corrections");
    replay.provenance = read_provenance(r);
  });
  return replay;
}

void write_replay(const ReplayRecord& replay, const std::filesystem::path& file) {
  Json tests = Json::array();
  for (const TestFit& test : replay.tests) tests.push_back(test_fit_json(test));
  write_whole(file, json_text(Json{{"format", k_replay_format},
                                   {"specimen", replay.specimen},
                                   {"bushing", replay.bushing},
                                   {"tests", tests},
                                   {"warnings", notes_json(replay.warnings)},
                                   {"corrections", notes_json(replay.corrections)},
                                   {"provenance", provenance_json(replay.provenance)}}));
}

}  // namespace grouser
