// OpenVDB grids of fields on a lattice: index (i, j, k) is the sample's, active where the stored value differs from the
// background, in level sets from -background too. Blocks of 8^3 samples become leaves, or tiles where all samples are
// stored alike.
//
// This file takes seconds to compile, most of them for OpenVDB's headers: what needs none of them is in the files
// beside it. Grids and trees come from OpenVDB's registry of types and not from their constructors, which would compile
// again, for each type, everything that a tree can do and that the library has already: another half minute.
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "io/files/seekable_output.h"
#include "io/vdb/check_lattice.h"
#include "io/vdb/grid_tree.h"
#include "io/vdb/hashing_buffer.h"
#include "io/vdb/leaf_layer.h"
#include "io/vdb/stored_values.h"
#include "io/vdb/vdb_module.h"

namespace raycone {
namespace {

using vdb::kLeafLog2, vdb::kLeafSize, vdb::LeafLayer, vdb::to_coord;
static_assert(kVdbSlabAlignment == kLeafSize);

// --- A grid without its tree ----------------------------------------------------------------------------------------

openvdb::Vec3d to_vec(const Vec3& v) { return {v.x, v.y, v.z}; }
openvdb::Vec4d to_row(const Vec3& v, double last) { return {v.x, v.y, v.z, last}; }

openvdb::math::MapBase::Ptr map_of(const PlacedLattice& lattice) {
  const openvdb::Vec3d scale = to_vec(lattice.grid.spacing), translation = to_vec(lattice.origin);
  if (!lattice.along_axes()) {
    openvdb::Mat4d matrix = openvdb::Mat4d::identity();  // of row vectors
    for (int axis = 0; axis < 3; ++axis) matrix.setRow(axis, to_row(lattice.steps[static_cast<std::size_t>(axis)], 0));
    matrix.setRow(3, to_row(lattice.origin, 1));
    return std::make_shared<openvdb::math::AffineMap>(matrix);
  }
  const bool cubic = scale.x() == scale.y() && scale.y() == scale.z();
  if (cubic) return std::make_shared<openvdb::math::UniformScaleTranslateMap>(scale.x(), translation);
  return std::make_shared<openvdb::math::ScaleTranslateMap>(scale, translation);
}

// Transform's constructor recomputes a map's scale as the difference of two transformed points, which costs digits
// where the translation is large; a transform that is read has the map as it was written.
openvdb::math::Transform::Ptr transform_of(const PlacedLattice& lattice) {
  const openvdb::math::MapBase::Ptr map = map_of(lattice);
  std::stringstream bytes;
  bytes.exceptions(std::ios_base::badbit);  // lest it keep a lack of memory to itself
  openvdb::writeString(bytes, map->type());
  map->write(bytes);
  openvdb::io::setCurrentVersion(bytes);
  auto transform = std::make_shared<openvdb::math::Transform>();
  transform->read(bytes);
  return transform;
}

void insert(openvdb::GridBase& grid, const char* key, const std::string& value) {
  grid.insertMeta(key, openvdb::StringMetadata(value));
}
void insert(openvdb::GridBase& grid, const char* key, std::uint64_t value) {
  grid.insertMeta(key, openvdb::Int64Metadata(static_cast<openvdb::Int64>(value)));
}
void insert(openvdb::GridBase& grid, const char* key, const openvdb::Coord& value) {
  grid.insertMeta(key, openvdb::Vec3IMetadata(value.asVec3i()));
}

void insert(openvdb::GridBase& grid, const char* key, const std::array<double, 16>& matrix) {
  grid.insertMeta(key, openvdb::Mat4DMetadata(openvdb::Mat4d(matrix.data())));
}

std::string joined_by_blanks(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

openvdb::GridClass class_of(FieldKind kind) {
  if (kind == FieldKind::kDensity) return openvdb::GRID_FOG_VOLUME;
  if (kind == FieldKind::kDistance) return openvdb::GRID_LEVEL_SET;
  return openvdb::GRID_UNKNOWN;
}

void describe(openvdb::GridBase& grid, const PlacedLattice& placed, const FieldDescription& field,
              const OutputDescription& description) {
  grid.setName(field.grid);
  const Lattice& lattice = placed.grid;
  grid.setTransform(transform_of(placed));
  if (const openvdb::GridClass grid_class = class_of(field.kind); grid_class != openvdb::GRID_UNKNOWN) {
    grid.setGridClass(grid_class);
  }
  if (field.kind == FieldKind::kVector) grid.setVectorType(openvdb::VEC_COVARIANT);  // as a gradient is
  insert(grid, "raycone_version", RAYCONE_VERSION);
  insert(grid, "raycone_field", field.name);
  if (!field.rule.empty()) insert(grid, "raycone_rule", field.rule);
  insert(grid, "raycone_mesh", description.mesh);
  insert(grid, "raycone_sha256", description.mesh_sha256);
  insert(grid, "raycone_index_min", to_coord(lattice.index_min[0], lattice.index_min[1], lattice.index_min[2]));
  insert(grid, "raycone_index_max", to_coord(lattice.index_max(0), lattice.index_max(1), lattice.index_max(2)));
  if (!description.options.empty()) insert(grid, "raycone_options", joined_by_blanks(description.options));
  if (field.kind == FieldKind::kLabel) insert(grid, "raycone_labels", description.label_names);
  insert(grid, "raycone_transform", description.transform);
  insert(grid, "raycone_faces", description.faces);
  if (description.is(Precision::kHalf) && vdb::has_chosen_precision(field.kind)) grid.setSaveFloatAsHalf(true);
}

// --- Grids in the making --------------------------------------------------------------------------------------------

class GridBuilder {
 public:
  virtual ~GridBuilder() = default;
  // Takes the next slab of the lattice.
  virtual void add(const LatticeBlock& slab, const FieldValues& values) = 0;
  // The same of distances.
  virtual void add(const SignedBlocks& blocks) = 0;
  // The complete grid.
  [[nodiscard]] virtual openvdb::GridBase::ConstPtr finish(const FieldTotals& totals) = 0;
};

// Store: one of io/vdb/stored_values.h.
template <typename Tree, typename Store>
class TypedGridBuilder final : public GridBuilder {
 public:
  using Number = typename Store::Number;
  using Stored = typename Store::Stored;

  // `grid`: without a tree; `background`: far away.
  TypedGridBuilder(const openvdb::GridBase::Ptr& grid, const Lattice& lattice, const Store& store, Stored background)
      : grid_(grid),
        lattice_(lattice),
        store_(store),
        is_active_{background, grid->getGridClass() == openvdb::GRID_LEVEL_SET} {
    tree().root().setBackground(static_cast<typename Tree::ValueType>(background), /*updateChildNodes=*/false);
  }

  void add(const LatticeBlock& slab, const FieldValues& values) override {
    const auto numbers = std::get<std::span<const Number>>(values);
    if (!layer_) layer_.emplace(lattice_, is_active_.background);
    const std::int64_t end = slab.first[2] + slab.counts[2];
    for (std::int64_t z = slab.first[2]; z < end;) {
      const std::int64_t leaf_z = z >> kLeafLog2;
      const std::int64_t layer_end = std::min((leaf_z + 1) * kLeafSize, lattice_.index_max(2) + 1);
      const std::int64_t next = std::min(layer_end, end);
      layer_->gather(slab, numbers, z, next, store_);
      if (next == layer_end) {
        vdb::add_layer(tree(), *layer_, leaf_z, is_active_);
        layer_->clear();
      }
      z = next;
    }
  }

  void add(const SignedBlocks& blocks) override {
    if constexpr (vdb::kIsDistance<Store>) vdb::add_blocks(tree(), blocks, store_, is_active_);
  }

  openvdb::GridBase::ConstPtr finish(const FieldTotals& totals) override {
    insert(*grid_, "raycone_exterior_edges", totals.exterior_edges);
    insert(*grid_, "raycone_degenerate", totals.degenerate);
    insert(*grid_, "raycone_on_surface", totals.on_surface);
    openvdb::tools::pruneTiles(tree());
    return grid_;
  }

 private:
  Tree& tree() { return static_cast<Tree&>(grid_->baseTree()); }

  openvdb::GridBase::Ptr grid_;
  Lattice lattice_;
  Store store_;
  vdb::Activity<Stored> is_active_;
  std::optional<LeafLayer<Stored>> layer_;  // where numbers come by slabs
};

// What builders are made of.
struct GridPlan {
  const FieldDescription& field;
  const PlacedLattice& lattice;
  const OutputDescription& description;
};

template <typename Grid, typename Store>
std::unique_ptr<GridBuilder> make_builder(const GridPlan& plan, const Store& store, typename Store::Stored background) {
  const openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(Grid::gridType());
  describe(*grid, plan.lattice, plan.field, plan.description);
  return std::make_unique<TypedGridBuilder<typename Grid::TreeType, Store>>(grid, plan.lattice.grid, store, background);
}

// Store: see StoreDistance.
template <typename Grid, typename Store>
std::unique_ptr<GridBuilder> make_level_set_builder(const GridPlan& plan, const Store& store) {
  using Value = typename Grid::ValueType;
  const double band_width = plan.field.background;
  const Precision precision = plan.description.precision.value_or(Precision::kSingle);
  const auto background = vdb::level_set_background<Value>(band_width, plan.lattice.grid.spacing.x, precision);
  const vdb::StoreDistance<Store> stored{band_width, background, vdb::next_within(background, precision), store};
  return make_builder<Grid>(plan, stored, background);
}

// Of 32 or 16 bits, as the user chose.
vdb::StoreFloat narrow_store(const GridPlan& plan) {
  return {Narrowing(plan.field, plan.description.is(Precision::kHalf) ? Digits::kHalf : Digits::kSingle)};
}

// Components as Store keeps numbers.
template <typename Store, typename Vector>
struct StoreVector {
  using Number = Vec3;
  using Stored = Vector;
  Stored operator()(const Vec3& v) const { return {store(v.x), store(v.y), store(v.z)}; }
  Store store;
};

std::unique_ptr<GridBuilder> make_vector_builder(const GridPlan& plan) {
  using openvdb::Vec3f;
  if (plan.description.is(Precision::kDouble)) {
    using Wide = StoreVector<vdb::StoreDouble, openvdb::Vec3d>;
    return make_builder<openvdb::Vec3DGrid>(plan, Wide{}, openvdb::Vec3d(0.0));
  }
  return make_builder<openvdb::Vec3SGrid>(plan, StoreVector<vdb::StoreFloat, Vec3f>{narrow_store(plan)}, Vec3f(0.0F));
}

std::unique_ptr<GridBuilder> make_builder(const GridPlan& plan) {
  using openvdb::BoolGrid, openvdb::DoubleGrid, openvdb::FloatGrid;
  const double background = plan.field.background;
  const auto narrow_background = static_cast<float>(background);
  const bool wide = plan.description.is(Precision::kDouble);
  switch (plan.field.kind) {
    case FieldKind::kFlag:
      return make_builder<BoolGrid>(plan, vdb::StoreFlag{}, background != 0.0);
    case FieldKind::kLabel:
      return make_builder<openvdb::Int32Grid>(plan, vdb::StoreLabel{}, static_cast<std::int32_t>(background));
    case FieldKind::kCount:
      return make_builder<FloatGrid>(plan, vdb::StoreCount{}, narrow_background);
    case FieldKind::kBound:
      return make_builder<FloatGrid>(plan, vdb::StoreFloat{Narrowing(plan.field)}, narrow_background);
    case FieldKind::kDistance:
      if (wide) return make_level_set_builder<DoubleGrid>(plan, vdb::StoreDouble{});
      return make_level_set_builder<FloatGrid>(plan, narrow_store(plan));
    case FieldKind::kVector:
      return make_vector_builder(plan);
    case FieldKind::kReal:
    case FieldKind::kDensity:
      break;
  }
  if (wide) return make_builder<DoubleGrid>(plan, vdb::StoreDouble{}, background);
  return make_builder<FloatGrid>(plan, narrow_store(plan), narrow_background);
}

// --- The file -------------------------------------------------------------------------------------------------------

// OpenVDB offers files with the offsets that its file reader needs by name only, not on a stream.
class SeekableArchive : public openvdb::io::Archive {
 public:
  void write_to(std::ostream& stream, const openvdb::GridCPtrVec& grids) const {
    write(stream, grids, /*seekable=*/true);
  }
};

void write_archive(std::ostream& stream, const openvdb::GridCPtrVec& grids) {
  vdb::HashingBuffer hashing(*stream.rdbuf());
  std::ostream hashed(&hashing);
  SeekableArchive archive;
  const bool blosc = openvdb::io::Archive::hasBloscCompression();
  archive.setCompression((blosc ? openvdb::io::COMPRESS_BLOSC : openvdb::io::COMPRESS_ZIP) |
                         openvdb::io::COMPRESS_ACTIVE_MASK);
  archive.write_to(hashed, grids);
  const std::streampos end = stream.tellp();
  stream.seekp(vdb::HashingBuffer::kIdentifierOffset);
  stream << hashing.identifier();
  stream.seekp(end);
}

class VdbWriter final : public LatticeWriter {
 public:
  VdbWriter(OutputFile& output, const PlacedLattice& lattice, const OutputDescription& description) : output_(output) {
    for (const FieldDescription& field : description.fields) {
      builders_.push_back(make_builder({field, lattice, description}));
    }
  }

  int slab_axis() const override { return 2; }
  std::int64_t slab_alignment() const override { return kVdbSlabAlignment; }

  void write(const LatticeBlock& block, std::span<const FieldValues> fields) override {
    for (std::size_t f = 0; f < fields.size(); ++f) builders_[f]->add(block, fields[f]);
  }

  bool takes_blocks() const override { return true; }
  void write_blocks(const SignedBlocks& blocks) override { builders_.front()->add(blocks); }

  void finish(const FieldTotals& totals) override {
    openvdb::GridCPtrVec grids;
    for (const std::unique_ptr<GridBuilder>& builder : builders_) grids.push_back(builder->finish(totals));
    make_sure_of_memory();
    write_archive(output_.stream(), grids);
    output_.commit();
  }

 private:
  // Blosc crashes where it gets no memory. What is given back here is free for it. Throws std::bad_alloc.
  static void make_sure_of_memory() {
    constexpr std::size_t kInAll = std::size_t{1} << 20, kPerThread = std::size_t{1} << 17;
    void* volatile block = ::operator new(kInAll + kPerThread * static_cast<std::size_t>(thread_count()));
    ::operator delete(block);
  }

  SeekableOutput output_;
  std::vector<std::unique_ptr<GridBuilder>> builders_;  // of each field
};

}  // namespace

std::unique_ptr<LatticeWriter> vdb::make_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                        const OutputDescription& description) {
  check_lattice(lattice, description, output.name());
  openvdb::initialize();
  return std::make_unique<VdbWriter>(output, lattice, description);
}

}  // namespace raycone
