// What the volumes of medical imaging, NRRD and NIfTI, have in common: a head and then the samples of one field, x
// fastest. Both place the middles of voxels: here the samples, in the mesh's own coordinates, which viewers take for
// right, anterior, superior. Written here because a head is all there is to write: libnifti would want the whole volume
// in memory.
#pragma once

#include <memory>
#include <string>

#include "core/data/placed_lattice.h"
#include "core/data/vec3.h"
#include "io/fields/field_writer.h"
#include "io/files/output_file.h"

namespace raycone {

enum class ImageElement { kByte, kFloat, kDouble, kInteger };  // unsigned 8, 32, 64, and signed 32 bits

// How the first field, which is the only one, is stored.
[[nodiscard]] ImageElement image_element(const OutputDescription& description);

[[nodiscard]] Vec3 first_sample(const PlacedLattice& lattice);

enum class Packed { kSamples, kFile };  // what is compressed where the description says so

// Precondition: description.components() == 1.
[[nodiscard]] std::unique_ptr<LatticeWriter> make_image_writer(OutputFile& output, const OutputDescription& description,
                                                               const std::string& head, Packed packed);

}  // namespace raycone
