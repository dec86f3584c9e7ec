// Writers of fields: on lattices VDB, CSV and NPY; at points CSV and NPY.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/diagnostics.h"
#include "core/lattice.h"
#include "core/vec3.h"
#include "io/output_file.h"

namespace raycone {

enum class FieldFormat { kVdb, kCsv, kNpy };

// "vdb", "csv" or "npy", in any case.
[[nodiscard]] std::optional<FieldFormat> field_format_from_name(std::string_view name);

// What a file says about itself (VDB metadata).
struct FieldDescription {
  std::string field = "winding";  // also the grid's name
  std::string mesh;               // file name without directory
  std::string mesh_sha256;
  std::string rule;  // empty where the field has none: not written then
  std::uint64_t faces = 0;
  std::uint64_t exterior_edges = 0;
  bool double_precision = false;  // DoubleGrid / float64 instead of float32
  bool diagnostics = false;       // written too: further columns of CSV, further grids of VDB
};

// Known only when all values are.
struct FieldTotals {
  std::uint64_t degenerate = 0;
  std::uint64_t on_surface = 0;
};

// Takes the values of a lattice block by block. Blocks are slabs that span the lattice across `slab_axis()`, in
// increasing order, together all samples.
class LatticeWriter {
 public:
  virtual ~LatticeWriter() = default;
  // 2 (VDB, CSV) or 0 (NPY, whose slowest axis is x).
  [[nodiscard]] virtual int slab_axis() const = 0;
  // A slab that ends at multiples of this index (but for the last) is written best: 8 for VDB's leaves, else 1.
  [[nodiscard]] virtual std::int64_t slab_alignment() const = 0;
  // values.size() == block.size(), x fastest, then y, then z. `diagnostics` are null unless the writer was made for
  // them.
  virtual void write(const LatticeBlock& block, std::span<const double> values, const Diagnostics* diagnostics) = 0;
  // Completes and commits the file. Throws OutputError.
  virtual void finish(const FieldTotals& totals) = 0;
};

// `output` must outlive the writer. Throws OutputError where the format cannot hold the lattice (VDB: voxel volume
// below 3e-15, indices beyond 32 bits). NPY holds one number per sample, hence no diagnostics.
[[nodiscard]] std::unique_ptr<LatticeWriter> make_lattice_writer(FieldFormat format, OutputFile& output,
                                                                 const Lattice& lattice,
                                                                 const FieldDescription& description);

// Takes values at points, in their order. CSV: header "x,y,z,w", then a row per point; NPY: float64, shape (n,). With
// diagnostics, CSV has columns for them and NPY the shape (n, 5): the value, crossings, degenerate, on_surface,
// error_bound.
class PointWriter {
 public:
  virtual ~PointWriter() = default;
  // `diagnostics` are null unless the writer was made for them.
  virtual void write(std::span<const Vec3> points, std::span<const double> values, const Diagnostics* diagnostics) = 0;
  // Hands what has been written to the system, for readers that wait for it.
  virtual void flush() = 0;
  virtual void finish() = 0;
};

// format: kCsv or kNpy. `size`, where known, lets NPY be streamed to a pipe.
[[nodiscard]] std::unique_ptr<PointWriter> make_point_writer(FieldFormat format, OutputFile& output,
                                                             std::optional<std::uint64_t> size, bool diagnostics);

}  // namespace raycone
