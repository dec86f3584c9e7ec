#include "io/fields/read_image_lattice.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "io/fields/nifti_head.h"
#include "io/fields/nrrd_head.h"
#include "io/files/file_error.h"
#include "io/files/input_buffer.h"
#include "io/files/unpack.h"

namespace raycone {
namespace {

[[noreturn]] void fail_image(const std::string& path, const std::string& what) {
  throw InputError(path + ": not a readable volume: " + what);
}

InputBuffer beginning_of(const std::string& path) {
  InputBuffer input(path, unpacked(open_source(path), path));
  while (input.pending().size() < kNiftiHead && input.fill()) continue;
  return input;
}

// A sample's place takes finite numbers, also on the way to it.
PlacedLattice checked(const std::string& path, const PlacedLattice& lattice) {
  if (*std::ranges::min_element(lattice.grid.counts) < 1) fail_image(path, "its size, expected at least one voxel");
  if (!lattice.is_finite()) fail_image(path, "its place, expected finite numbers");
  if (!lattice.spans_space()) fail_image(path, "its axes, expected three directions");
  return lattice;
}

}  // namespace

bool is_image(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  try {
    const InputBuffer input = beginning_of(path);
    return input.pending().starts_with(kNrrdMagic) || begins_as_nifti(input.pending());
  } catch (const InputError&) {
    return false;  // whoever reads it next says why
  }
}

bool is_nrrd(const std::string& path) { return beginning_of(path).pending().starts_with(kNrrdMagic); }

PlacedLattice read_image_lattice(const std::string& path) {
  return checked(path, is_nrrd(path) ? nrrd_lattice(path, read_nrrd_head(path)) : read_nifti_lattice(path));
}

}  // namespace raycone
