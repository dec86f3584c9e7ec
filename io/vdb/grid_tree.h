// The trees of OpenVDB grids, filled with blocks of 8^3 samples: leaves, or tiles where all samples are stored alike.
#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tree/ValueAccessor.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/data/distance_blocks.h"
#include "core/machine/threads.h"
#include "io/vdb/leaf_layer.h"

namespace raycone::vdb {

inline openvdb::Coord to_coord(std::int64_t x, std::int64_t y, std::int64_t z) {
  return {static_cast<openvdb::Int32>(x), static_cast<openvdb::Int32>(y), static_cast<openvdb::Int32>(z)};
}

// Which stored values are active voxels.
template <typename Stored>
struct Activity {
  bool operator()(Stored value) const { return value != background && !(level_set && value == -background); }
  Stored background;
  bool level_set;
};

template <typename Leaf, typename Stored>
std::unique_ptr<Leaf> make_leaf(const openvdb::Coord& origin, const Stored* values, const Activity<Stored>& is_active) {
  using Value = typename Leaf::ValueType;
  auto leaf = std::make_unique<Leaf>(origin, Value{0}, false);
  typename Leaf::NodeMaskType active;
  for (openvdb::Index32 i = 0; i < kLeafVoxels; ++i) active.set(i, is_active(values[i]));
  leaf->setValueMask(active);
  if constexpr (std::is_same_v<Value, bool>) {  // one bit a voxel
    typename Leaf::NodeMaskType on;
    for (openvdb::Index32 i = 0; i < kLeafVoxels; ++i) on.set(i, values[i] != 0);
    leaf->buffer() = typename Leaf::Buffer(on);
  } else {
    std::copy_n(values, kLeafVoxels, leaf->buffer().data());
  }
  return leaf;
}

// Adds a leaf; where there is none, its voxels have one value, and become a tile unless that is the background.
template <typename Tree, typename Leaf, typename Stored>
void add_node(openvdb::tree::ValueAccessor<Tree>& to, const openvdb::Coord& origin, std::unique_ptr<Leaf> leaf,
              Stored value, const Activity<Stored>& is_active) {
  if (leaf) {
    to.addLeaf(leaf.release());
  } else if (value != is_active.background) {
    to.addTile(1, origin, static_cast<typename Tree::ValueType>(value), is_active(value));
  }
}

// `samples`: eight along each axis.
inline bool is_on_one_side(const SignedBlocks& blocks, const LatticeBlock& samples) {
  const auto sides = [&](std::int64_t j, std::int64_t k) {
    const std::span<const std::uint8_t> row =
        blocks.inside_from({samples.first[0], samples.first[1] + j, samples.first[2] + k});
    std::uint64_t eight = 0;
    static_assert(sizeof eight == kLeafSize);
    std::memcpy(&eight, row.data(), sizeof eight);
    return eight;
  };
  const std::uint64_t first = sides(0, 0);
  if (first != 0 && first != 0x0101010101010101) return false;
  std::uint64_t differences = 0;
  for (std::int64_t k = 0; k < kLeafSize; ++k) {
    for (std::int64_t j = 0; j < kLeafSize; ++j) differences |= sides(j, k) ^ first;
  }
  return differences == 0;
}

// Adds the leaves of a layer to `tree`, those of one value as tiles. `leaf_z`: the layer's leaf coordinate along z.
template <typename Tree, typename Stored>
void add_layer(Tree& tree, const LeafLayer<Stored>& layer, std::int64_t leaf_z, const Activity<Stored>& is_active) {
  using Leaf = typename Tree::LeafNodeType;
  const auto origin = [&](std::size_t n) {
    const auto [x, y] = layer.first_voxel(n);
    return to_coord(x, y, leaf_z * kLeafSize);
  };
  std::vector<std::unique_ptr<Leaf>> leaves(layer.size());
  parallel_for_each(leaves.size(), 16, [&](std::size_t n) {
    if (!layer.has_one_value(n)) leaves[n] = make_leaf<Leaf>(origin(n), layer.values(n), is_active);
  });
  openvdb::tree::ValueAccessor<Tree> accessor(tree);
  for (std::size_t n = 0; n < leaves.size(); ++n)
    add_node(accessor, origin(n), std::move(leaves[n]), *layer.values(n), is_active);
}

// The stored values of a block, in OpenVDB's order; what is beside the lattice is background. Returns whether all are
// known to be the first one, the only one that is set then.
template <typename Store, typename Stored>
bool store_block(const SignedBlocks& blocks, const LatticeIndex& place, const Store& store, Stored background,
                 Stored* values) {
  const LatticeBlock samples = blocks.distances.samples_of(place);
  const std::span<const double> numbers = blocks.distances.numbers(place);
  if (numbers.empty() && samples.size() == static_cast<std::int64_t>(kLeafVoxels) && is_on_one_side(blocks, samples)) {
    const double beyond = blocks.distances.beyond();
    values[0] = store(blocks.inside_from(samples.first)[0] != 0 ? -beyond : beyond);
    return true;
  }
  if (samples.size() != static_cast<std::int64_t>(kLeafVoxels)) std::fill_n(values, kLeafVoxels, background);
  for (std::int64_t k = samples.first[2]; k < samples.first[2] + samples.counts[2]; ++k) {
    for (std::int64_t j = samples.first[1]; j < samples.first[1] + samples.counts[1]; ++j) {
      const std::span<const std::uint8_t> inside = blocks.inside_from({samples.first[0], j, k});
      const std::size_t from = DistanceBlocks::index_in_block({samples.first[0], j, k});
      Stored* const column = values + (samples.first[0] & (kLeafSize - 1)) * kLeafSize * kLeafSize +
                             (j & (kLeafSize - 1)) * kLeafSize + (k & (kLeafSize - 1));
      for (std::size_t i = 0; i < static_cast<std::size_t>(samples.counts[0]); ++i) {
        const double number = numbers.empty() ? blocks.distances.beyond() : numbers[from + i];
        column[i * kLeafSize * kLeafSize] = store(inside[i] != 0 ? -number : number);
      }
    }
  }
  return false;
}

// Adds the leaves of blocks to `tree`, those of one value as tiles.
template <typename Tree, typename Store, typename Stored>
void add_blocks(Tree& tree, const SignedBlocks& blocks, const Store& store, const Activity<Stored>& is_active) {
  using Leaf = typename Tree::LeafNodeType;
  struct Made {
    std::unique_ptr<Leaf> leaf;
    Stored value;  // where there is no leaf
  };
  const LatticeBlock places = blocks.distances.blocks();
  const auto origin = [&](std::size_t n) {
    const auto [x, y, z] = places.index_of(n);
    return to_coord(x * kLeafSize, y * kLeafSize, z * kLeafSize);
  };
  std::vector<Made> made(static_cast<std::size_t>(places.size()));
  parallel_for(made.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::array<Stored, kLeafVoxels> values;
    for (std::size_t n = begin; n < end; ++n) {
      const bool is_one = store_block(blocks, places.index_of(n), store, is_active.background, values.data()) ||
                          std::all_of(values.begin(), values.end(), [&](Stored v) { return v == values[0]; });
      made[n].value = values[0];
      if (!is_one) made[n].leaf = make_leaf<Leaf>(origin(n), values.data(), is_active);
    }
  });
  openvdb::tree::ValueAccessor<Tree> accessor(tree);
  for (std::size_t n = 0; n < made.size(); ++n)
    add_node(accessor, origin(n), std::move(made[n].leaf), made[n].value, is_active);
}

}  // namespace raycone::vdb
