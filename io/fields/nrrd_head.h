// The head of an NRRD file, as teem.sourceforge.net/nrrd/format.html describes it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/placed_lattice.h"
#include "io/files/input_buffer.h"

namespace raycone {

inline constexpr std::string_view kNrrdMagic = "NRRD000";

struct NrrdHead {
  std::map<std::string, std::string, std::less<>> fields;  // "field: description"; the names in small letters
  std::map<std::string, std::string, std::less<>> pairs;   // "key:=value", unescaped
};

// Of a file that begins with kNrrdMagic and of which nothing has been consumed. Throws InputError where the head has no
// end.
[[nodiscard]] NrrdHead read_nrrd_head(InputBuffer& input);

// The sizes of all axes, as many as there are before what is none.
[[nodiscard]] std::vector<std::uint64_t> nrrd_shape(const NrrdHead& head);

// The samples of three axes of the world, in right, anterior, superior; index 0 is the first one. Other axes, as those
// of colours, are left out. `path`: of the file, for errors. Throws InputError where the head does not say where the
// samples lie.
[[nodiscard]] PlacedLattice nrrd_lattice(const std::string& path, const NrrdHead& head);

}  // namespace raycone
