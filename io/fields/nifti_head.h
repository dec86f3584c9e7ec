// The head of a NIfTI-1 file, as nifti1.h describes it.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/placed_lattice.h"

namespace raycone {

// Its fields, by their offsets.
class NiftiHead {
 public:
  // `bytes`: nifti::kHeadSize of them.
  NiftiHead(std::string_view bytes, std::endian order) : bytes_(bytes), order_(order) {}

  [[nodiscard]] std::int16_t integer(std::size_t offset) const;
  [[nodiscard]] double real(std::size_t offset) const;
  // Up to its end or the first zero.
  [[nodiscard]] std::string text(std::size_t offset, std::size_t room) const;

 private:
  std::string bytes_;
  std::endian order_;
};

// The head that `bytes` begin with, in either byte order; absent where they do not.
[[nodiscard]] std::optional<NiftiHead> nifti_head(std::string_view bytes);

// Whether they are of NIfTI-2, which is not read.
[[nodiscard]] bool is_nifti2(std::string_view bytes);

// The voxels by the sform, else by the qform, in right, anterior, superior; index 0 is the first one. `path`: of the
// file, for errors. Throws InputError where the head has neither.
[[nodiscard]] PlacedLattice nifti_lattice(const std::string& path, const NiftiHead& head);

struct NiftiFacts {
  std::string type;  // of the elements, as nifti1.h calls it, in small letters
  std::vector<std::uint64_t> shape;
  std::string description;
};
[[nodiscard]] NiftiFacts nifti_facts(const NiftiHead& head);

}  // namespace raycone
