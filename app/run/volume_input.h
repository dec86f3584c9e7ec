// Files of values, for `raycone info`.
#pragma once

#include <string>

#include "io/fields/volume_facts.h"

namespace raycone {

// Whether the file at `path` is one by its content: OpenVDB, NPZ, NRRD or NIfTI-1. False also where it cannot be read;
// "-" is none.
[[nodiscard]] bool holds_values(const std::string& path);

// What such a file says about itself. Throws InputError where it is damaged, LimitError, std::bad_alloc.
[[nodiscard]] VolumeFacts facts_of_file(const std::string& path);

}  // namespace raycone
