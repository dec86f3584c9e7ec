// The writers behind make_lattice_writer and make_point_writer, one file per format.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/data/placed_lattice.h"
#include "io/fields/field_writer.h"
#include "io/files/output_file.h"
#include "io/files/raw_precision.h"

namespace raycone {

[[nodiscard]] std::unique_ptr<LatticeWriter> make_vdb_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                                     const OutputDescription& description);
[[nodiscard]] std::unique_ptr<LatticeWriter> make_csv_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                                     const OutputDescription& description);
[[nodiscard]] std::unique_ptr<LatticeWriter> make_npy_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                                     const OutputDescription& description);
[[nodiscard]] std::unique_ptr<LatticeWriter> make_vti_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                                     const OutputDescription& description);

[[nodiscard]] std::unique_ptr<LatticeWriter> make_nrrd_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                                      const OutputDescription& description);
[[nodiscard]] std::unique_ptr<LatticeWriter> make_nifti_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                                       const OutputDescription& description);
[[nodiscard]] std::unique_ptr<LatticeWriter> make_npz_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                                     const OutputDescription& description);

[[nodiscard]] std::unique_ptr<PointWriter> make_csv_point_writer(OutputFile& output,
                                                                 const OutputDescription& description);
[[nodiscard]] std::unique_ptr<PointWriter> make_npy_point_writer(OutputFile& output, std::optional<std::uint64_t> size,
                                                                 const OutputDescription& description);

[[nodiscard]] std::unique_ptr<PointWriter> make_npz_point_writer(OutputFile& output, std::optional<std::uint64_t> size,
                                                                 const OutputDescription& description);
[[nodiscard]] std::unique_ptr<PointWriter> make_raw_point_writer(OutputFile& output, RawPrecision precision,
                                                                 const OutputDescription& description);

}  // namespace raycone
