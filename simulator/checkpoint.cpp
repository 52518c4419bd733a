#include "simulator/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/errors.h"
#include "model/provenance.h"

namespace grouser {
namespace {

constexpr std::string_view k_format = "grouser.checkpoint/2";
constexpr std::size_t k_digest_length = 64;  // of SHA-256 in hex
constexpr std::size_t k_head_length = k_format.size() + 1 + k_digest_length + 1;

std::filesystem::path file_in(const std::filesystem::path& folder) { return folder / "checkpoint"; }

[[noreturn]] void refuse(const std::filesystem::path& folder, const std::string& place, const std::string& expected,
                         const std::string& found, const std::string& hint) {
  throw InputError(InputFinding{file_in(folder).string(), place, expected, found, hint});
}

std::string document_digest(const std::string& text) { return text.empty() ? text : sha256_of(text); }
std::string shown_digest(const std::string& digest) { return digest.empty() ? "none" : "SHA-256 " + digest; }

void compare(const std::filesystem::path& folder, const CheckpointIdentity& own, const CheckpointIdentity& stored) {
  if (own.program_version != stored.program_version) {
    refuse(folder, "program version", "a checkpoint of grouser " + own.program_version,
           "one of grouser " + stored.program_version, "run it anew, or go on with that version");
  }
  std::vector<InputFinding> findings;
  for (std::size_t i = 0; i < own.inputs.size(); ++i) {
    if (own.inputs[i] == stored.inputs[i]) continue;
    findings.push_back({file_in(folder).string(), k_checkpoint_inputs[i],
                        "the input that the run was started with, " + shown_digest(stored.inputs[i]),
                        shown_digest(own.inputs[i]), "--resume needs the same files and --set options"});
  }
  if (!findings.empty()) throw InputError(findings);
}

}  // namespace

CheckpointIdentity identity_of(const Scenario& scenario) {
  const ScenarioDocuments& documents = scenario.documents;
  return {program_version(),
          {document_digest(documents.scenario), document_digest(documents.vehicle), document_digest(documents.bushing),
           document_digest(documents.side_bushing[0]), document_digest(documents.side_bushing[1]),
           document_digest(documents.profile)}};
}

void CheckpointReader::bytes(void* to, std::size_t size) {
  if (size > payload_.size() - at_) refuse("all parts of a run", "an end before the last of them");
  std::copy_n(payload_.data() + at_, size, static_cast<char*>(to));
  at_ += size;
}

std::size_t CheckpointReader::size(std::size_t now) {
  std::uint64_t stored = 0;
  bytes(&stored, sizeof stored);
  if (now > 0 && stored != now) refuse(fmt::format("{} numbers, as the vehicle has them", now), fmt::to_string(stored));
  if (stored > payload_.size()) refuse("all parts of a run", fmt::format("one of {} numbers", stored));
  return stored;
}

void CheckpointReader::refuse(const std::string& expected, const std::string& found) const {
  throw InputError(InputFinding{file_.string(), "", expected, found, "start the run without --resume"});
}

void write_checkpoint(const std::filesystem::path& folder, const CheckpointIdentity& identity,
                      const CheckpointWriter& parts) {
  CheckpointWriter head;
  CheckpointIdentity stored = identity;
  head(stored);
  const std::string payload = head.payload() + parts.payload();
  write_whole(file_in(folder), fmt::format("{} {}\n{}", k_format, sha256_of(payload), payload));
}

CheckpointReader read_checkpoint(const std::filesystem::path& folder, const CheckpointIdentity& identity) {
  if (!std::filesystem::exists(file_in(folder))) {
    refuse(folder, "", "a checkpoint to go on from", "no such file", "start the run without --resume");
  }
  const std::string whole = read_whole(file_in(folder));
  if (!whole.starts_with(k_format)) refuse(folder, "", "a " + std::string(k_format), "another kind of file", "");
  const std::string payload = whole.size() < k_head_length ? "" : whole.substr(k_head_length);
  if (payload.empty() || whole.substr(k_format.size() + 1, k_digest_length) != sha256_of(payload)) {
    refuse(folder, "", "bytes that fit their checksum", "others: cut short or damaged",
           "start the run without --resume");
  }
  CheckpointReader reader(payload, file_in(folder));
  CheckpointIdentity stored;
  reader(stored);
  compare(folder, identity, stored);
  return reader;
}

}  // namespace grouser
