#include "io/fields/field_writer.h"

#include <stdexcept>

#include "io/fields/format_writers.h"

namespace raycone {
namespace {

class NoLatticeWriter : public LatticeWriter {
 public:
  [[nodiscard]] int slab_axis() const override { return 2; }
  [[nodiscard]] std::int64_t slab_alignment() const override { return 1; }
  void write(const LatticeBlock& /*block*/, std::span<const FieldValues> /*fields*/) override {}
  void finish(const FieldTotals& /*totals*/) override {}
};

class NoPointWriter : public PointWriter {
 public:
  void write(std::span<const Vec3> /*points*/, std::span<const FieldValues> /*fields*/) override {}
  void flush() override {}
  void finish() override {}
};

}  // namespace

void LatticeWriter::write_blocks(const SignedBlocks& /*blocks*/) {
  throw std::logic_error("LatticeWriter: takes no blocks");
}

std::unique_ptr<LatticeWriter> make_lattice_writer(FieldFormat format, OutputFile& output, const PlacedLattice& lattice,
                                                   const OutputDescription& description) {
  switch (format) {
    case FieldFormat::kVdb:
      return make_vdb_lattice_writer(output, lattice, description);
    case FieldFormat::kCsv:
      return make_csv_lattice_writer(output, lattice, description);
    case FieldFormat::kNpy:
      return make_npy_lattice_writer(output, lattice, description);
    case FieldFormat::kNone:
      return std::make_unique<NoLatticeWriter>();
    case FieldFormat::kVti:
      return make_vti_lattice_writer(output, lattice, description);
    case FieldFormat::kNpz:
      return make_npz_lattice_writer(output, lattice, description);
    case FieldFormat::kNrrd:
      return make_nrrd_lattice_writer(output, lattice, description);
    case FieldFormat::kNifti:
    case FieldFormat::kNiftiGz:
      return make_nifti_lattice_writer(output, lattice, description);
    case FieldFormat::kRawDouble:
    case FieldFormat::kRawSingle:
      break;  // for points only; options are checked before anything is opened
  }
  throw std::logic_error("no lattice writer for this format");
}

std::unique_ptr<PointWriter> make_point_writer(FieldFormat format, OutputFile& output,
                                               std::optional<std::uint64_t> size,
                                               const OutputDescription& description) {
  switch (format) {
    case FieldFormat::kCsv:
      return make_csv_point_writer(output, description);
    case FieldFormat::kNpy:
      return make_npy_point_writer(output, size, description);
    case FieldFormat::kNpz:
      return make_npz_point_writer(output, size, description);
    case FieldFormat::kRawDouble:
      return make_raw_point_writer(output, RawPrecision::kDouble, description);
    case FieldFormat::kRawSingle:
      return make_raw_point_writer(output, RawPrecision::kSingle, description);
    case FieldFormat::kNone:
      return std::make_unique<NoPointWriter>();
    case FieldFormat::kVdb:
    case FieldFormat::kVti:
    case FieldFormat::kNrrd:
    case FieldFormat::kNifti:
    case FieldFormat::kNiftiGz:
      break;  // lattices only; options are checked before anything is opened
  }
  throw std::logic_error("no point writer for this format");
}

}  // namespace raycone
