#pragma once
#include <map>
#include <string>

#include "model/json_document.h"

namespace grouser {

/// Replaces values of a document before it is read. Paths are dotted ("integrator.max_step_ms", "drive.left.time_s.1")
/// or slashed ("/integrator/max_step_ms"). A quantity given in another unit takes the place of the one that stands
/// there. A key that nobody knows is left for the reader to find; a path through something that is not there becomes a
/// finding.
void apply_override(Json& document, const std::string& path, const std::string& value, Findings& findings);

}  // namespace grouser
