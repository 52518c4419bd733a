// Writes the synthetic rig campaign: make_rig_campaign FOLDER. The same bytes every time.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "model/provenance.h"
#include "test_data/generator/campaign_files.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_rig_campaign FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    for (const auto& [name, bytes] : grouser::campaign_files()) grouser::write_whole(folder / name, bytes);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_rig_campaign: %s\n", error.what());
    return 5;
  }
  return 0;
}
