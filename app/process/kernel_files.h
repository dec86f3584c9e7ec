// Numbers in the files in which Linux tells of processes and machines, below /proc and /sys.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace raycone {

// The number behind `key`, a line's first word: "max" of "max 4096", "VmRSS:" of "VmRSS: 12 kB". In the file's own
// unit; nothing where the file cannot be read or has no such line.
[[nodiscard]] std::optional<double> number_behind(const std::filesystem::path& file, const std::string& key);

}  // namespace raycone
