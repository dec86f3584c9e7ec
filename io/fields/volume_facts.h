// What files of values on lattices, and of values at points, say about themselves.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/data/placed_lattice.h"
#include "io/files/file_error.h"

namespace raycone {

// An array, or a grid of OpenVDB, which has no shape.
struct ArrayFacts {
  std::string name;
  std::string type;  // as the format calls it
  std::vector<std::uint64_t> shape{};
};

// How a file was made.
struct MadeFact {
  std::string key;
  std::string value;
  bool is_json = false;  // of the value: JSON, else text
};

struct VolumeFacts {
  std::string format;              // "NPZ", "NRRD", "NIfTI-1" or "OpenVDB"
  std::vector<ArrayFacts> arrays;  // fields first
  std::optional<PlacedLattice> lattice;
  std::string no_lattice;  // why there is none; empty where nothing hints at one
  std::vector<MadeFact> made;
  std::string made_json;  // the same as an object of JSON, where the format keeps it so; not checked
};

// The lattice that read() returns or, where it throws InputError about `path`, why there is none.
template <typename Read>
void set_lattice(VolumeFacts& facts, const std::string& path, const Read& read) {
  try {
    facts.lattice = read();
  } catch (const InputError& error) {
    const std::string text = error.what();
    facts.no_lattice = text.starts_with(path + ": ") ? text.substr(path.size() + 2) : text;
  }
}

// Of an NPZ, NRRD or NIfTI-1 file. Throws InputError where it is damaged, or none of these.
[[nodiscard]] VolumeFacts read_volume_facts(const std::string& path);

}  // namespace raycone
