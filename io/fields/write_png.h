// PNG pictures, by libpng.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/files/output_file.h"

namespace raycone {

struct PngDescription {
  std::int64_t width = 0;  // 1 to 2^31 - 1
  std::int64_t height = 0;
  std::vector<std::pair<std::string, std::string>> texts;  // keyword (at most 79 Latin letters), text
};

// Writes 8-bit sRGB, three bytes a pixel, row by row from the top, and commits. Throws OutputError, std::bad_alloc.
void write_png(OutputFile& output, const PngDescription& description, std::span<const std::uint8_t> rgb);

}  // namespace raycone
