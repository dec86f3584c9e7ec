// `raycone info` about files of values: where their samples lie, and how they were made.
#pragma once

#include <string>

#include "io/fields/volume_facts.h"

namespace raycone {

struct VolumeInfo {
  std::string file;  // as named on the command line
  VolumeFacts facts;
};

// Aligned text for people.
[[nodiscard]] std::string info_text(const VolumeInfo& info);

}  // namespace raycone
