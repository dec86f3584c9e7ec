// What a shell may offer for a value, told from what stands for it in the help.
#pragma once

#include <string>
#include <vector>

namespace raycone {

enum class FileCandidates { kNone, kAny, kDirectories };

struct ValueCandidates {
  std::vector<std::string> words;  // to be typed as they are; "abs=" goes on with a number
  bool list = false;               // several of them, with commas between
  FileCandidates files = FileCandidates::kNone;
};

// Stands for the name of a command.
inline constexpr const char* kCommandPlaceholder = "COMMAND";

// `placeholder` is that of an option ("exact|none|D", "winding|sdf[,...]", "OUT.npy") or the name of an operand
// ("MESH|DIR"): what begins with a small letter is a word; OUT, FILE, GRID, REPORT, MESH, POINTS are files, DIR is a
// directory, COMMAND one of raycone's commands; all else, such as D, is for the user alone.
[[nodiscard]] ValueCandidates candidates_for(const std::string& placeholder);

}  // namespace raycone
