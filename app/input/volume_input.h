// Files of values, for `raycone info`, and what tells them apart.
#pragma once

#include <string>

#include "io/fields/volume_facts.h"

namespace raycone {

// Whether the file at `path` is one by its content: OpenVDB, NPZ, NRRD or NIfTI-1. False also where it cannot be read;
// "-" is none.
[[nodiscard]] bool holds_values(const std::string& path);

// Whether the regular file at `path` begins as OpenVDB's do; false where it cannot be read.
[[nodiscard]] bool is_vdb(const std::string& path);

// What a file of values says about itself. Throws InputError where it is damaged, LimitError, std::bad_alloc.
[[nodiscard]] VolumeFacts facts_of_file(const std::string& path);

}  // namespace raycone
