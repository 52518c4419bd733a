#include "model/provenance.h"
#include "render/render.h"

namespace grouser {

std::string film_mark(const Runs& runs) {
  std::string digests;
  for (const RunFolder* run : runs) {
    for (const char* part : {"run.h5", "inputs/vehicle.json", "inputs/scenario.json"})
      digests += sha256_of_file(run->path / part) + "\n";
  }
  return "grouser film of " + sha256_of(digests);
}

}  // namespace grouser
