// libFuzzer target of the readers for --like and info but OpenVDB's: NPZ, NRRD and NIfTI-1. Whatever the bytes, they
// return a lattice with samples at finite places, or throw InputError.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "io/fields/read_image_lattice.h"
#include "io/fields/read_npz_lattice.h"
#include "io/fields/volume_facts.h"
#include "io/files/file_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int descriptor = memfd_create("lattice", 0);
  if (descriptor < 0 || write(descriptor, data, size) != static_cast<ssize_t>(size)) std::abort();
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  try {
    const raycone::VolumeFacts facts = raycone::read_volume_facts(path);
    if (facts.format.empty() || (facts.lattice && !facts.no_lattice.empty())) std::abort();
  } catch (const raycone::InputError&) {
  }
  try {
    const raycone::PlacedLattice lattice =
        raycone::is_image(path) ? raycone::read_image_lattice(path) : raycone::read_npz_lattice(path);
    const raycone::Box box = box_of(lattice);
    for (int axis = 0; axis < 3; ++axis) {
      if (lattice.grid.counts[static_cast<std::size_t>(axis)] < 1 || !(lattice.grid.spacing[axis] > 0.0)) std::abort();
      if (!std::isfinite(box.lower[axis]) || !std::isfinite(box.upper[axis])) std::abort();
    }
  } catch (const raycone::InputError&) {
  }
  close(descriptor);
  return 0;
}
