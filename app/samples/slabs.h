// How a lattice is cut for evaluation and writing, and the memory that takes.
#pragma once

#include <cstdint>

#include "app/fields/fields.h"
#include "core/data/lattice.h"
#include "io/fields/field_writer.h"

namespace raycone {

// Samples of a slab where nothing speaks against it.
inline constexpr std::int64_t kSlabSamples = std::int64_t{1} << 22;

// The slab of `lattice` that starts at index `first` along `axis`: whole layers of about `samples` in all. It ends
// before a multiple of `alignment`, or at the lattice's end; it has at least one layer, or one aligned group.
[[nodiscard]] LatticeBlock slab_from(const Lattice& lattice, int axis, std::int64_t alignment, std::int64_t first,
                                     std::int64_t samples = kSlabSamples);

// What the memory of a slab and of its writer depends on, beside the samples and their fields.
struct SlabKind {
  bool open = false;    // the mesh has exterior edges
  bool turned = false;  // the lattice is not along the axes: its numbers are sorted, or its samples' places kept
  bool blocks = false;  // distances take room in the band alone, how much is not known
};

// How many samples a slab has that takes a third of `left` bytes: from 1 to kSlabSamples.
[[nodiscard]] std::int64_t slab_samples(const FieldOptions& options, SlabKind kind, double left);

// Bytes that a slab takes: its numbers, and what is needed to find and to write them.
[[nodiscard]] double slab_memory(const LatticeBlock& slab, const FieldOptions& options, SlabKind kind);

// The bytes that evaluating so many samples takes beside slabs, mesh and trees, where a far field may pay: its
// operators, scratch memory of threads, ends of heaps. Measured: with less, lattices of small open meshes could end in
// mid-work.
[[nodiscard]] double working_memory(SlabKind kind, double samples);

// The bytes that the writer of `format` surely needs for `lattice`. For VDB: the grids, and the blocks in the making;
// winding numbers of an open mesh and their error bounds differ everywhere, all else only at a surface. For CSV: a text
// for each index along x.
[[nodiscard]] double writer_memory(const Lattice& lattice, FieldFormat format, const OutputDescription& description,
                                   SlabKind kind);

}  // namespace raycone
