// OpenVDB grids of fields on a lattice: index (i, j, k) is the sample's, active where the stored value differs from the
// background, in level sets from -background too. Blocks of 8^3 samples become leaves, or tiles where all samples are
// stored alike.
#include <openvdb/io/Archive.h>
#include <openvdb/io/Compression.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <sstream>
#include <streambuf>
#include <string>
#include <type_traits>
#include <vector>

#include "core/machine/threads.h"
#include "io/fields/narrowing.h"
#include "io/files/file_error.h"
#include "io/files/read_file.h"
#include "io/files/seekable_output.h"
#include "io/vdb/vdb_module.h"

namespace raycone {
namespace {

constexpr std::int64_t kLeafLog2 = 3;
constexpr std::int64_t kLeafSize = 1 << kLeafLog2;
constexpr std::size_t kLeafVoxels = 512;

// --- The lattice

void check_indices(const Lattice& lattice, const std::string& name) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t first = lattice.index_min[static_cast<std::size_t>(axis)];
    const std::int64_t last = lattice.index_max(axis);
    if (first < std::numeric_limits<std::int32_t>::min() || last > std::numeric_limits<std::int32_t>::max()) {
      throw OutputError(name + ": lattice indices " + std::to_string(first) + " to " + std::to_string(last) +
                        " do not fit in the 32 bits of OpenVDB");
    }
  }
}

// The voxel that OpenVDB gives to copies of a grid, also while it writes one: the difference of two positions.
Vec3 copied_spacing(const Lattice& lattice) {
  Vec3 result{};
  for (int axis = 0; axis < 3; ++axis) {
    result[axis] = (lattice.origin[axis] + lattice.spacing[axis]) - lattice.origin[axis];
  }
  return result;
}

// OpenVDB takes a transform whose determinant is below 3e-15 for singular, however well scaled it is.
void check_voxels(const Lattice& lattice, const std::string& name) {
  constexpr double kLeastVolume = 3e-15;
  const auto volume_of = [](const Vec3& spacing) { return spacing.x * spacing.y * spacing.z; };
  const Vec3& spacing = lattice.spacing;
  const double volume = volume_of(spacing);
  char message[200];
  if (volume < kLeastVolume) {
    const double mean_exponent = (std::log10(spacing.x) + std::log10(spacing.y) + std::log10(spacing.z)) / 3;
    std::snprintf(message, sizeof message,
                  ": voxel volume %.2g is below 3e-15, which OpenVDB cannot represent; scale the mesh (--scale 1e%.0f)",
                  volume, -std::floor(mean_exponent));
    throw OutputError(name + message);
  }
  if (!(volume_of(copied_spacing(lattice)) >= kLeastVolume)) {  // infinity times 0 is refused, too
    std::snprintf(message, sizeof message,
                  ": voxels of %.2g x %.2g x %.2g at (%.2g, %.2g, %.2g) are too small beside their coordinates, which "
                  "OpenVDB cannot represent; expected larger ones, or bounds nearer to 0",
                  spacing.x, spacing.y, spacing.z, lattice.origin.x, lattice.origin.y, lattice.origin.z);
    throw OutputError(name + message);
  }
}

// Halves range from 2^-14, below which they lose digits, to 65504.
void check_half(const OutputDescription& description, const Lattice& lattice, const std::string& name) {
  if (!description.half_precision) return;
  for (const FieldDescription& field : description.fields) {
    if (field.kind != FieldKind::kDistance) continue;
    if (lattice.spacing.x >= 0x1p-14 && field.background <= 65504) continue;
    char message[160];
    std::snprintf(
        message, sizeof message,
        ": distances from one voxel, %.2g, to the band's %.2g are not in the range 6.2e-5 to 65504 of --half; "
        "scale the mesh (--scale)",
        lattice.spacing.x, field.background);
    throw OutputError(name + message);
  }
}

openvdb::math::MapBase::Ptr map_of(const Lattice& lattice) {
  const openvdb::Vec3d scale(lattice.spacing.x, lattice.spacing.y, lattice.spacing.z);
  const openvdb::Vec3d translation(lattice.origin.x, lattice.origin.y, lattice.origin.z);
  const bool cubic = scale.x() == scale.y() && scale.y() == scale.z();
  if (cubic) return std::make_shared<openvdb::math::UniformScaleTranslateMap>(scale.x(), translation);
  return std::make_shared<openvdb::math::ScaleTranslateMap>(scale, translation);
}

// Transform's constructor recomputes a map's scale as the difference of two transformed points, which costs digits
// where the translation is large; a transform that is read has the map as it was written.
openvdb::math::Transform::Ptr transform_of(const Lattice& lattice) {
  const openvdb::math::MapBase::Ptr map = map_of(lattice);
  std::stringstream bytes;
  openvdb::writeString(bytes, map->type());
  map->write(bytes);
  openvdb::io::setCurrentVersion(bytes);
  auto transform = std::make_shared<openvdb::math::Transform>();
  transform->read(bytes);
  return transform;
}

openvdb::Coord to_coord(std::int64_t x, std::int64_t y, std::int64_t z) {
  return {static_cast<openvdb::Int32>(x), static_cast<openvdb::Int32>(y), static_cast<openvdb::Int32>(z)};
}

// --- The tree

// Gathers the samples of all leaf blocks of one layer (equal leaf coordinate along z), then turns them into leaves and
// tiles. Leaf coordinates are sample indices divided by 8, rounded down.
template <typename Tree>
class LeafLayer {
 public:
  using Value = typename Tree::ValueType;
  using Leaf = typename Tree::LeafNodeType;
  // How a value waits for its leaf: a vector of bool could not be written to by several threads.
  using Stored = std::conditional_t<std::is_same_v<Value, bool>, std::uint8_t, Value>;

  LeafLayer(const Lattice& lattice, Value background, bool level_set)
      : lattice_(lattice), background_(background), level_set_(level_set) {
    for (std::size_t a = 0; a < 2; ++a) {
      first_[a] = lattice.index_min[a] >> kLeafLog2;
      counts_[a] = (lattice.index_max(static_cast<int>(a)) >> kLeafLog2) - first_[a] + 1;
    }
    values_.assign(leaf_count() * kLeafVoxels, background_);
    is_uniform_.assign(leaf_count(), 0);
  }

  // Takes the planes z_begin <= z < z_end, all in this layer, from a slab of the lattice; store(number) is what is kept
  // of each sample's number.
  template <typename Number, typename Store>
  void gather(const LatticeBlock& slab, std::span<const Number> numbers, std::int64_t z_begin, std::int64_t z_end,
              const Store& store) {
    const Planes<Number> planes{slab, numbers, z_begin, z_end};
    parallel_for(static_cast<std::size_t>(counts_[1]), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) gather_row(planes, row, store);
    });
  }

  // Adds the leaves and tiles of the layer at leaf coordinate `leaf_z` to `tree` and starts the next layer.
  void move_to(Tree& tree, std::int64_t leaf_z) {
    std::vector<std::unique_ptr<Leaf>> leaves(leaf_count());
    parallel_for(leaves.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) leaves[n] = make_leaf(n, origin(n, leaf_z));
    });
    openvdb::tree::ValueAccessor<Tree> accessor(tree);
    for (std::size_t n = 0; n < leaves.size(); ++n) {
      const Stored value = values_[n * kLeafVoxels];
      if (leaves[n]) {
        accessor.addLeaf(leaves[n].release());
      } else if (value != background_) {
        accessor.addTile(1, origin(n, leaf_z), static_cast<Value>(value), is_active(value));
      }
    }
    parallel_for(leaves.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) clear(n);
    });
  }

 private:
  [[nodiscard]] bool is_active(Stored value) const {
    return value != background_ && !(level_set_ && value == -background_);
  }

  void clear(std::size_t n) {
    const auto begin = values_.begin() + static_cast<std::ptrdiff_t>(n * kLeafVoxels);
    std::fill_n(begin, is_uniform_[n] ? 1 : kLeafVoxels, background_);
    is_uniform_[n] = 0;
  }

  [[nodiscard]] std::size_t leaf_count() const { return static_cast<std::size_t>(counts_[0] * counts_[1]); }

  [[nodiscard]] openvdb::Coord origin(std::size_t n, std::int64_t leaf_z) const {
    const std::int64_t leaf_x = first_[0] + static_cast<std::int64_t>(n) % counts_[0];
    const std::int64_t leaf_y = first_[1] + static_cast<std::int64_t>(n) / counts_[0];
    return to_coord(leaf_x * kLeafSize, leaf_y * kLeafSize, leaf_z * kLeafSize);
  }

  // Planes of a slab.
  template <typename Number>
  struct Planes {
    const LatticeBlock& slab;
    std::span<const Number> numbers;
    std::int64_t z_begin;
    std::int64_t z_end;

    // From the slab's first sample along x.
    const Number* line(std::int64_t y, std::int64_t z) const {
      const std::int64_t lines = (z - slab.first[2]) * slab.counts[1] + (y - slab.first[1]);
      return &numbers[static_cast<std::size_t>(lines * slab.counts[0])];
    }
  };

  struct Range {
    std::int64_t begin;
    std::int64_t end;
  };
  // The samples along an axis that slab and leaf block have in common.
  static Range common(const LatticeBlock& slab, std::size_t axis, std::int64_t leaf) {
    return {std::max(leaf * kLeafSize, slab.first[axis]),
            std::min((leaf + 1) * kLeafSize, slab.first[axis] + slab.counts[axis])};
  }

  // A row of leaf blocks along x. Those whose numbers are all equal, as they mostly are, are not filled.
  template <typename Number, typename Store>
  void gather_row(const Planes<Number>& planes, std::size_t row, const Store& store) {
    const Range y = common(planes.slab, 1, first_[1] + static_cast<std::int64_t>(row));
    find_uniform(planes, row, y);
    for (std::int64_t i = 0; i < counts_[0]; ++i) {
      const std::size_t n = row * static_cast<std::size_t>(counts_[0]) + static_cast<std::size_t>(i);
      const Range x = common(planes.slab, 0, first_[0] + i);
      if (is_uniform_[n]) {
        values_[n * kLeafVoxels] = store(planes.line(y.begin, planes.z_begin)[x.begin - planes.slab.first[0]]);
      } else {
        gather_leaf(planes, n, x, y, store);
      }
    }
  }

  // Line by line, in the order of memory, for all leaf blocks of a row at once.
  template <typename Number>
  void find_uniform(const Planes<Number>& planes, std::size_t row, const Range& y) {
    std::uint8_t* const uniform = &is_uniform_[row * static_cast<std::size_t>(counts_[0])];
    const bool is_whole = y.end - y.begin == kLeafSize && planes.z_end - planes.z_begin == kLeafSize;
    const std::int64_t offset = first_[0] * kLeafSize - planes.slab.first[0];  // of the first leaf in the line
    const std::int64_t begin = offset < 0 ? 1 : 0;
    const std::int64_t end = (planes.slab.counts[0] - offset) / kLeafSize;
    std::fill_n(uniform, counts_[0], std::uint8_t{0});
    if (!is_whole || begin >= end) return;
    std::fill(uniform + begin, uniform + end, std::uint8_t{1});
    const Number* const first = planes.line(y.begin, planes.z_begin);
    for (std::int64_t z = planes.z_begin; z < planes.z_end; ++z) {
      for (std::int64_t line_y = y.begin; line_y < y.end; ++line_y) {
        const Number* const line = planes.line(line_y, z);
        for (std::int64_t i = begin; i < end; ++i) {
          const std::int64_t start = offset + i * kLeafSize;
          bool differs = false;
          for (std::int64_t x = start; x < start + kLeafSize; ++x) differs |= line[x] != first[start];
          uniform[i] &= static_cast<std::uint8_t>(!differs);
        }
      }
    }
  }

  template <typename Number, typename Store>
  void gather_leaf(const Planes<Number>& planes, std::size_t n, const Range& x, const Range& y, const Store& store) {
    Stored* const leaf = &values_[n * kLeafVoxels];
    for (std::int64_t z = planes.z_begin; z < planes.z_end; ++z) {
      for (std::int64_t leaf_y = y.begin; leaf_y < y.end; ++leaf_y) {
        const Number* const line = planes.line(leaf_y, z);
        Stored* const column = leaf + (leaf_y & (kLeafSize - 1)) * kLeafSize + (z & (kLeafSize - 1));
        for (std::int64_t leaf_x = x.begin; leaf_x < x.end; ++leaf_x) {
          column[(leaf_x & (kLeafSize - 1)) * kLeafSize * kLeafSize] = store(line[leaf_x - planes.slab.first[0]]);
        }
      }
    }
  }

  // Nothing where all values are equal.
  [[nodiscard]] std::unique_ptr<Leaf> make_leaf(std::size_t n, const openvdb::Coord& leaf_origin) const {
    if (is_uniform_[n]) return nullptr;
    const auto begin = values_.begin() + static_cast<std::ptrdiff_t>(n * kLeafVoxels);
    const auto end = begin + kLeafVoxels;
    if (std::all_of(begin + 1, end, [&](Stored value) { return value == *begin; })) return nullptr;
    auto leaf = std::make_unique<Leaf>(leaf_origin, Value{0}, false);
    typename Leaf::NodeMaskType active;
    for (openvdb::Index32 i = 0; i < kLeafVoxels; ++i) active.set(i, is_active(begin[i]));
    leaf->setValueMask(active);
    if constexpr (std::is_same_v<Value, bool>) {  // one bit a voxel
      typename Leaf::NodeMaskType on;
      for (openvdb::Index32 i = 0; i < kLeafVoxels; ++i) on.set(i, begin[i] != 0);
      leaf->buffer() = typename Leaf::Buffer(on);
    } else {
      std::copy(begin, end, leaf->buffer().data());
    }
    return leaf;
  }

  Lattice lattice_;
  Stored background_;
  bool level_set_;
  std::array<std::int64_t, 2> first_{};   // leaf coordinates along x and y
  std::array<std::int64_t, 2> counts_{};  // leaf blocks along x and y
  std::vector<Stored> values_;            // leaf by leaf, x fastest; in each leaf OpenVDB's order: z fastest
  std::vector<std::uint8_t> is_uniform_;  // per leaf: all of its voxels have its first value, the others are not set
};

// --- The grids

void insert(openvdb::GridBase& grid, const char* key, const std::string& value) {
  grid.insertMeta(key, openvdb::StringMetadata(value));
}
void insert(openvdb::GridBase& grid, const char* key, std::uint64_t value) {
  grid.insertMeta(key, openvdb::Int64Metadata(static_cast<openvdb::Int64>(value)));
}
void insert(openvdb::GridBase& grid, const char* key, const openvdb::Coord& value) {
  grid.insertMeta(key, openvdb::Vec3IMetadata(value.asVec3i()));
}

openvdb::GridClass class_of(FieldKind kind) {
  if (kind == FieldKind::kDensity) return openvdb::GRID_FOG_VOLUME;
  if (kind == FieldKind::kDistance) return openvdb::GRID_LEVEL_SET;
  return openvdb::GRID_UNKNOWN;
}

void describe(openvdb::GridBase& grid, const Lattice& lattice, const FieldDescription& field,
              const OutputDescription& description) {
  grid.setName(field.grid);
  grid.setTransform(transform_of(lattice));
  if (const openvdb::GridClass grid_class = class_of(field.kind); grid_class != openvdb::GRID_UNKNOWN) {
    grid.setGridClass(grid_class);
  }
  insert(grid, "raycone_version", RAYCONE_VERSION);
  insert(grid, "raycone_field", field.name);
  if (!field.rule.empty()) insert(grid, "raycone_rule", field.rule);
  insert(grid, "raycone_mesh", description.mesh);
  insert(grid, "raycone_sha256", description.mesh_sha256);
  insert(grid, "raycone_index_min", to_coord(lattice.index_min[0], lattice.index_min[1], lattice.index_min[2]));
  insert(grid, "raycone_index_max", to_coord(lattice.index_max(0), lattice.index_max(1), lattice.index_max(2)));
  insert(grid, "raycone_faces", description.faces);
  insert(grid, "raycone_exterior_edges", description.exterior_edges);
}

// Fields other than diagnostics: their precision is for the user to choose.
bool is_value(FieldKind kind) {
  return kind == FieldKind::kReal || kind == FieldKind::kDensity || kind == FieldKind::kDistance;
}

// A bound as a float that still is one.
float rounded_up(double bound) {
  const float nearest = static_cast<float>(bound);
  return static_cast<double>(nearest) < bound ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
                                              : nearest;
}

// The value of 16 bits that OpenVDB stores for `value`, within their range.
float as_half(float value) {
  const float largest = std::numeric_limits<openvdb::math::half>::max();
  return openvdb::io::truncateRealToHalf(std::clamp(value, -largest, largest));
}

// The next value of 16 bits, upwards.
float next_half(float value) {
  openvdb::math::half half(value);
  const unsigned short bits = half.bits();
  constexpr unsigned short kSign = 0x8000;
  const bool negative = (bits & kSign) != 0 && bits != kSign;
  half.setBits(static_cast<unsigned short>(negative ? bits - 1 : (bits & ~kSign) + 1));
  return half;
}

Narrowing narrowing_of(const FieldDescription& field, bool half) {
  if (!half) return Narrowing(field);
  return {field, [](double value) { return as_half(static_cast<float>(value)); }, &next_half};
}

// The least value that is no narrower than the band, also as checkLevelSet measures it: in voxels.
template <typename Value>
Value level_set_background(double band_width, double voxel, bool half) {
  auto background = static_cast<Value>(band_width);
  const auto stored = [&] { return half ? static_cast<Value>(as_half(static_cast<float>(background))) : background; };
  while (static_cast<double>(stored()) / voxel < band_width / voxel) {
    background = std::nextafter(std::max(background, stored()), std::numeric_limits<Value>::infinity());
  }
  return stored();
}

template <typename Value>
Value background_of(const FieldDescription& field, const Lattice& lattice, bool half) {
  if constexpr (!std::is_same_v<Value, bool>) {
    if (field.kind == FieldKind::kDistance) {
      return level_set_background<Value>(field.background, lattice.spacing.x, half);
    }
    return static_cast<Value>(field.background);
  } else {
    return field.background != 0.0;
  }
}

// A distance of `band_width` or more is stored as the background, a lesser one as a value of lesser magnitude.
template <typename Value>
Value stored_distance(double distance, double band_width, Value background) {
  if (std::abs(distance) >= band_width) return distance < 0 ? -background : background;
  const Value most = std::nextafter(background, Value{0});
  return std::clamp(static_cast<Value>(distance), -most, most) + Value{0};
}

// One grid in the making.
class GridBuilder {
 public:
  virtual ~GridBuilder() = default;
  // Takes the next slab of the lattice.
  virtual void add(const LatticeBlock& slab, const FieldValues& values) = 0;
  // The complete grid.
  [[nodiscard]] virtual openvdb::GridBase::ConstPtr finish(const FieldTotals& totals) = 0;
};

template <typename Grid>
class TypedGridBuilder final : public GridBuilder {
 public:
  using Value = typename Grid::ValueType;

  TypedGridBuilder(const FieldDescription& field, const Lattice& lattice, const OutputDescription& description)
      : field_(field),
        lattice_(lattice),
        half_(description.half_precision && is_value(field.kind)),
        narrowing_(narrowing_of(field, half_)),
        background_(background_of<Value>(field, lattice, half_)),
        layer_(lattice, background_, field.kind == FieldKind::kDistance),
        grid_(Grid::create(background_)) {
    describe(*grid_, lattice, field, description);
    if (half_) grid_->setSaveFloatAsHalf(true);
  }

  void add(const LatticeBlock& slab, const FieldValues& values) override {
    std::visit([&](const auto& numbers) { add_numbers(slab, numbers); }, values);
  }

  openvdb::GridBase::ConstPtr finish(const FieldTotals& totals) override {
    insert(*grid_, "raycone_degenerate", totals.degenerate);
    insert(*grid_, "raycone_on_surface", totals.on_surface);
    openvdb::tools::pruneTiles(grid_->tree());
    return grid_;
  }

 private:
  template <typename Number>
  void add_numbers(const LatticeBlock& slab, std::span<const Number> numbers) {
    if constexpr (std::is_same_v<Value, bool>) {
      gather(slab, numbers, [](Number flag) { return static_cast<std::uint8_t>(flag); });
    } else if (field_.kind == FieldKind::kBound) {
      gather(slab, numbers, [](Number bound) { return static_cast<Value>(rounded_up(static_cast<double>(bound))); });
    } else if (field_.kind == FieldKind::kDistance) {
      gather(slab, numbers, [this](Number distance) {
        return stored_distance(static_cast<double>(distance), field_.background, background_);
      });
    } else {
      // Adding 0 turns -0 into 0.
      gather(slab, numbers, [this](Number number) {
        const bool is_float = std::is_same_v<Value, float>;
        const auto value = static_cast<double>(number);
        return (is_float ? static_cast<Value>(narrowing_(value)) : static_cast<Value>(value)) + Value{0};
      });
    }
  }

  template <typename Number, typename Store>
  void gather(const LatticeBlock& slab, std::span<const Number> numbers, const Store& store) {
    const std::int64_t end = slab.first[2] + slab.counts[2];
    for (std::int64_t z = slab.first[2]; z < end;) {
      const std::int64_t leaf_z = z >> kLeafLog2;
      const std::int64_t layer_end = std::min((leaf_z + 1) * kLeafSize, lattice_.index_max(2) + 1);
      const std::int64_t next = std::min(layer_end, end);
      layer_.gather(slab, numbers, z, next, store);
      if (next == layer_end) layer_.move_to(grid_->tree(), leaf_z);
      z = next;
    }
  }

  FieldDescription field_;
  Lattice lattice_;
  bool half_;  // 16 bits in the file
  Narrowing narrowing_;
  Value background_;
  LeafLayer<typename Grid::TreeType> layer_;
  typename Grid::Ptr grid_;
};

// Integers become floats: pyopenvdb reads no file that holds a grid of integers.
std::unique_ptr<GridBuilder> make_builder(const FieldDescription& field, const Lattice& lattice,
                                          const OutputDescription& description) {
  using openvdb::BoolGrid, openvdb::DoubleGrid, openvdb::FloatGrid;
  if (field.kind == FieldKind::kFlag) return std::make_unique<TypedGridBuilder<BoolGrid>>(field, lattice, description);
  const bool wide = description.double_precision && field.kind != FieldKind::kBound && field.kind != FieldKind::kCount;
  if (wide) return std::make_unique<TypedGridBuilder<DoubleGrid>>(field, lattice, description);
  return std::make_unique<TypedGridBuilder<FloatGrid>>(field, lattice, description);
}

// --- The file

// Passes all bytes on and hashes those behind the file header.
class HashingBuffer final : public std::streambuf {
 public:
  // The archive's identifier, 36 characters that OpenVDB draws at random, is the end of the file header.
  static constexpr std::size_t kIdentifierOffset = 21;
  static constexpr std::size_t kIdentifierSize = 36;

  explicit HashingBuffer(std::streambuf& target) : target_(target) {}

  // An identifier that depends on nothing but the bytes written.
  [[nodiscard]] std::string identifier() {
    fold();
    std::string text = hash_.substr(0, 32);
    for (const std::size_t position : {8U, 13U, 18U, 23U}) text.insert(position, 1, '-');
    return text;
  }

 protected:
  int_type overflow(int_type c) override {
    const char byte = traits_type::to_char_type(c);
    return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
  }
  std::streamsize xsputn(const char* data, std::streamsize size) override {
    if (passed_ >= kIdentifierOffset + kIdentifierSize) pending_.append(data, static_cast<std::size_t>(size));
    passed_ += static_cast<std::size_t>(size);
    constexpr std::size_t kFoldSize = std::size_t{1} << 20;
    if (pending_.size() >= kFoldSize) fold();
    return target_.sputn(data, size);
  }
  int sync() override { return target_.pubsync(); }
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction, std::ios_base::openmode which) override {
    return target_.pubseekoff(offset, direction, which);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override {
    return target_.pubseekpos(position, which);
  }

 private:
  void fold() {
    hash_ = sha256(hash_ + pending_);
    pending_.clear();
  }

  std::streambuf& target_;
  std::size_t passed_ = 0;
  std::string pending_;
  std::string hash_;
};

// OpenVDB offers files with the offsets that its file reader needs by name only, not on a stream.
class SeekableArchive : public openvdb::io::Archive {
 public:
  void write_to(std::ostream& stream, const openvdb::GridCPtrVec& grids) const {
    write(stream, grids, /*seekable=*/true);
  }
};

void write_archive(std::ostream& stream, const openvdb::GridCPtrVec& grids) {
  HashingBuffer hashing(*stream.rdbuf());
  std::ostream hashed(&hashing);
  SeekableArchive archive;
  const bool blosc = openvdb::io::Archive::hasBloscCompression();
  archive.setCompression((blosc ? openvdb::io::COMPRESS_BLOSC : openvdb::io::COMPRESS_ZIP) |
                         openvdb::io::COMPRESS_ACTIVE_MASK);
  archive.write_to(hashed, grids);
  const std::streampos end = stream.tellp();
  stream.seekp(HashingBuffer::kIdentifierOffset);
  stream << hashing.identifier();
  stream.seekp(end);
}

class VdbWriter final : public LatticeWriter {
 public:
  VdbWriter(OutputFile& output, const Lattice& lattice, const OutputDescription& description) : output_(output) {
    for (const FieldDescription& field : description.fields) {
      builders_.push_back(make_builder(field, lattice, description));
    }
  }

  int slab_axis() const override { return 2; }
  std::int64_t slab_alignment() const override { return kLeafSize; }

  void write(const LatticeBlock& block, std::span<const FieldValues> fields) override {
    for (std::size_t f = 0; f < fields.size(); ++f) builders_[f]->add(block, fields[f]);
  }

  void finish(const FieldTotals& totals) override {
    openvdb::GridCPtrVec grids;
    for (const std::unique_ptr<GridBuilder>& builder : builders_) grids.push_back(builder->finish(totals));
    write_archive(output_.stream(), grids);
    output_.commit();
  }

 private:
  SeekableOutput output_;
  std::vector<std::unique_ptr<GridBuilder>> builders_;  // of each field
};

}  // namespace

std::unique_ptr<LatticeWriter> vdb::make_lattice_writer(OutputFile& output, const Lattice& lattice,
                                                        const OutputDescription& description) {
  check_indices(lattice, output.name());
  check_voxels(lattice, output.name());
  check_half(description, lattice, output.name());
  openvdb::initialize();
  return std::make_unique<VdbWriter>(output, lattice, description);
}

}  // namespace raycone
