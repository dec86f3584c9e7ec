#include "io/fields/read_image_lattice.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "io/fields/nifti_fields.h"
#include "io/fields/volume_error.h"
#include "io/files/ascii.h"
#include "io/files/file_error.h"
#include "io/files/input_buffer.h"
#include "io/files/unpack.h"

namespace raycone {
namespace {

InputBuffer open_image(const std::string& path) {
  InputBuffer input(path, unpacked(open_source(path), path));
  while (input.pending().size() < nifti::kHeadSize && input.fill()) continue;
  return input;
}

// A sample's place takes finite numbers, also on the way to it.
PlacedLattice checked(const std::string& path, const PlacedLattice& lattice) {
  if (*std::ranges::min_element(lattice.grid.counts) < 1) fail_as_volume(path, "its size, expected at least one voxel");
  if (!lattice.is_finite()) fail_as_volume(path, "its place, expected finite numbers");
  if (!lattice.spans_space()) fail_as_volume(path, "its axes, expected three directions");
  return lattice;
}

}  // namespace

bool is_image(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  try {
    const InputBuffer input = open_image(path);
    return input.pending().starts_with(kNrrdMagic) || nifti_head(input.pending());
  } catch (const InputError&) {
    return false;  // whoever reads it next says why
  }
}

ImageHead read_image_head(const std::string& path) {
  InputBuffer input = open_image(path);
  if (input.pending().starts_with(kNrrdMagic)) return read_nrrd_head(input);
  if (const std::optional<NiftiHead> head = nifti_head(input.pending())) return *head;
  fail_as_volume(path, "its head is damaged");
}

PlacedLattice image_lattice(const std::string& path, const ImageHead& head) {
  const auto* const nrrd = std::get_if<NrrdHead>(&head);
  return checked(path, nrrd ? nrrd_lattice(path, *nrrd) : nifti_lattice(path, std::get<NiftiHead>(head)));
}

void fail_as_unknown_volume(const std::string& path) {
  const InputBuffer input = open_image(path);
  constexpr std::size_t kTold = 16;
  const std::string_view first = input.pending().substr(0, kTold);
  const std::string found = is_nifti2(first) ? "NIfTI-2" : first.empty() ? "no bytes" : "'" + excerpt(first) + "'";
  throw InputError(path + ": found " + found + ", expected OpenVDB, NPZ, NRRD or NIfTI-1");
}

PlacedLattice read_image_lattice(const std::string& path) { return image_lattice(path, read_image_head(path)); }

}  // namespace raycone
