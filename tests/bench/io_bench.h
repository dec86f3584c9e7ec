// Benchmarks of readers and writers.
#pragma once

#include <filesystem>

namespace raycone::bench {

// Registers read_format/NAME and line_ends/NAME, write_format/NAME. Their files are in `directory`, which stays until
// they have run.
void add_io_benchmarks(const std::filesystem::path& directory);

}  // namespace raycone::bench
