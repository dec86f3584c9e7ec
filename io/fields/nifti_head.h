// The head of a NIfTI-1 file, as nifti1.h describes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/placed_lattice.h"

namespace raycone {

inline constexpr std::size_t kNiftiHead = 348;  // bytes

// Whether they begin with such a head, in either byte order.
[[nodiscard]] bool begins_as_nifti(std::string_view bytes);

// The voxels by the sform, else by the qform, in right, anterior, superior; index 0 is the first one. Throws InputError
// where the head is damaged or has neither.
[[nodiscard]] PlacedLattice read_nifti_lattice(const std::string& path);

struct NiftiFacts {
  std::string type;  // of the elements, as nifti1.h calls it, in small letters
  std::vector<std::uint64_t> shape;
  std::string description;
};
[[nodiscard]] NiftiFacts read_nifti_facts(const std::string& path);

}  // namespace raycone
