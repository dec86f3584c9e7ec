// Writers of fields: on lattices VDB, CSV, NPY, NPZ, NRRD, NIfTI and VTI; at points CSV, NPY, NPZ and raw numbers.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/data/distance_blocks.h"
#include "core/data/lattice.h"
#include "core/data/placed_lattice.h"
#include "core/data/vec3.h"
#include "io/fields/field_format.h"
#include "io/files/output_file.h"

namespace raycone {

// What the numbers of a field are; formats choose how they store them.
enum class FieldKind {
  kReal,      // doubles, stored in the precision asked for
  kDensity,   // likewise: a fog volume
  kDistance,  // likewise: a level set, of magnitude `background` where it is not active
  kVector,    // three doubles, stored likewise; those beyond the range of fewer bits as the largest there
  kBound,     // doubles, rounded up where 32 bits are stored
  kCount,     // 64-bit integers
  kFlag,      // 0 or 1
  kLabel,     // which part a sample is in, from 1; 0: none
};

// One number or vector per sample, and its names.
struct FieldDescription {
  std::string name = "winding";  // in metadata
  std::string column = "w";      // of a table; of vectors those of the components, with commas between
  std::string grid = "winding";  // in VDB
  FieldKind kind = FieldKind::kReal;
  double background = 0.0;  // the value far away, where grids hold nothing
  std::string rule;         // of the run; not written where it is empty
  double threshold = 0.5;   // fewer digits keep numbers on its side (io/fields/narrowing.h); for kReal and kDensity
  bool threshold_of_magnitude = false;  // and so their magnitudes

  [[nodiscard]] std::size_t components() const { return kind == FieldKind::kVector ? 3 : 1; }
};

// Bits of a stored real number: 16, 32, 64.
enum class Precision { kHalf, kSingle, kDouble };

inline constexpr std::array<double, 16> kIdentity4{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

// What a file holds and says about itself.
struct OutputDescription {
  std::vector<FieldDescription> fields{{}};  // at least one
  std::string mesh;                          // file name without directory
  std::string mesh_sha256;
  std::uint64_t faces = 0;
  std::optional<Precision> precision;             // of real numbers: by default 32 bits on lattices, 64 at points
  bool compress = false;                          // NRRD, NIfTI: by gzip
  bool packs_flags = false;                       // NPZ: the field inside as bits
  bool has_places = false;                        // points have normals and faces
  bool single_points = false;                     // NPZ: points and normals as 32 bits
  std::array<double, 16> transform = kIdentity4;  // from the mesh's file to the world, row by row
  std::string metadata;                           // how this was made, as JSON
  std::vector<std::string> labels;                // names of 1, 2, ...
  std::string label_names;                        // the same as a JSON array; empty where there are no labels
  std::vector<std::string> options;               // that were given, each "--name=value" or "--name"

  [[nodiscard]] bool is(Precision wanted) const { return precision == wanted; }
  // Then NPY at points holds integers.
  [[nodiscard]] bool has_labels_alone() const { return fields.size() == 1 && fields.front().kind == FieldKind::kLabel; }
  // Numbers of a sample.
  [[nodiscard]] std::size_t components() const {
    std::size_t count = 0;
    for (const FieldDescription& field : fields) count += field.components();
    return count;
  }
};

// Of one field: integers for kCount and kLabel, bytes for kFlag, vectors for kVector, else doubles.
using FieldValues = std::variant<std::span<const double>, std::span<const std::int64_t>, std::span<const std::uint8_t>,
                                 std::span<const Vec3>, std::span<const std::int32_t>>;

// Known only when all values are.
struct FieldTotals {
  std::uint64_t degenerate = 0;
  std::uint64_t on_surface = 0;
  std::uint64_t exterior_edges = 0;  // of all parts where there are labels: they are prepared one after the other
};

// What VDB's writer has for slab_alignment(), along z: the side of a leaf.
inline constexpr std::int64_t kVdbSlabAlignment = 8;

// Takes the values of a lattice block by block. Blocks are slabs that span the lattice across `slab_axis()`, in
// increasing order, together all samples. Whatever writes throws OutputError. For one thread at a time.
class LatticeWriter {
 public:
  virtual ~LatticeWriter() = default;
  // 2; of NPY and NPZ, whose slowest axis is x, 1 or 0 (io/fields/lattice_array.h).
  [[nodiscard]] virtual int slab_axis() const = 0;
  // A slab that ends at multiples of this index (but for the last) is written best: 8 for VDB's leaves, else 1.
  [[nodiscard]] virtual std::int64_t slab_alignment() const = 0;
  // Of each field of the description, in its order, block.size() numbers: x fastest, then y, then z.
  virtual void write(const LatticeBlock& block, std::span<const FieldValues> fields) = 0;
  // Whether it takes distances, where they are the only field, by write_blocks() as well.
  [[nodiscard]] virtual bool takes_blocks() const { return false; }
  // Writes what write() would for the same numbers. The samples are a slab that ends where a block does, or the
  // lattice. Precondition: takes_blocks().
  virtual void write_blocks(const SignedBlocks& blocks);
  // Completes and commits the file.
  virtual void finish(const FieldTotals& totals) = 0;
};

// `output` must outlive the writer. Throws OutputError where the format cannot hold the lattice (VDB: voxel volume
// below 3e-15, indices beyond 32 bits, distances beyond the range of halves; VTI: indices beyond 32 bits; NIfTI: more
// than 32 767 samples along an axis, places beyond floats). NPY, NRRD and NIfTI hold one field; the last two no
// vectors, and like VTI no halves.
[[nodiscard]] std::unique_ptr<LatticeWriter> make_lattice_writer(FieldFormat format, OutputFile& output,
                                                                 const PlacedLattice& lattice,
                                                                 const OutputDescription& description);

// Takes fields at points, in their order. CSV: header "x,y,z,w" with the columns' names, then a row per point; NPY:
// shape (n,), with several numbers (n, numbers), all in the precision asked for; NPZ: an array of the points and one
// per field; raw: the numbers of the first point, those of the second, and so on. For one thread at a time.
class PointWriter {
 public:
  virtual ~PointWriter() = default;
  // Of each field of the description, in its order, points.size() numbers.
  virtual void write(std::span<const Vec3> points, std::span<const FieldValues> fields) = 0;
  // Where the description says so, normals of those points and the numbers of the faces they lie on. NPZ keeps them.
  virtual void write_places(std::span<const Vec3> /*normals*/, std::span<const std::int64_t> /*faces*/) {}
  // Hands what has been written to the system, for readers that wait for it.
  virtual void flush() = 0;
  virtual void finish() = 0;
};

// `size`, where known, lets NPY be streamed to a pipe, and NPZ do without copies of its arrays.
[[nodiscard]] std::unique_ptr<PointWriter> make_point_writer(FieldFormat format, OutputFile& output,
                                                             std::optional<std::uint64_t> size,
                                                             const OutputDescription& description);

}  // namespace raycone
