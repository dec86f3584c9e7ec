#include "tests/support/vdb_files.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Diagnostics.h>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <type_traits>

namespace raycone::test {
namespace {

openvdb::Coord coord(const VoxelIndex& at) { return {at.x, at.y, at.z}; }
Vec3 vec3(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }
openvdb::Vec3d vec3d(const Vec3& v) { return {v.x, v.y, v.z}; }

// What needs no type of tree.
class AnyGrid : public VdbGrid {
 public:
  explicit AnyGrid(openvdb::GridBase::ConstPtr grid) : grid_(std::move(grid)) {}

  std::uint64_t active_voxel_count() const override { return grid_->activeVoxelCount(); }
  std::uint64_t active_tile_count() const override { return grid_->baseTree().activeTileCount(); }
  std::uint32_t leaf_count() const override { return grid_->baseTree().leafCount(); }
  bool is_empty() const override { return grid_->empty(); }

  std::string name() const override { return grid_->getName(); }
  VdbClass grid_class() const override {
    switch (grid_->getGridClass()) {
      case openvdb::GRID_UNKNOWN:
        return VdbClass::kUnknown;
      case openvdb::GRID_FOG_VOLUME:
        return VdbClass::kFogVolume;
      case openvdb::GRID_LEVEL_SET:
        return VdbClass::kLevelSet;
      default:
        return VdbClass::kOther;
    }
  }
  bool saves_as_half() const override { return grid_->saveFloatAsHalf(); }
  Vec3 position(const VoxelIndex& at) const override { return vec3(grid_->indexToWorld(coord(at))); }
  Vec3 voxel_size() const override { return vec3(grid_->voxelSize()); }
  bool has_uniform_scale() const override { return grid_->transform().hasUniformScale(); }
  bool has_transform_of(const VdbGrid& other) const override {
    return grid_->transform() == dynamic_cast<const AnyGrid&>(other).grid_->transform();
  }

  bool has_metadata(const std::string& key) const override { return (*grid_)[key] != nullptr; }
  std::string text(const std::string& key) const override { return grid_->metaValue<std::string>(key); }
  std::int64_t integer(const std::string& key) const override { return grid_->metaValue<openvdb::Int64>(key); }
  std::array<int, 3> index(const std::string& key) const override {
    const auto value = grid_->metaValue<openvdb::Vec3i>(key);
    return {value.x(), value.y(), value.z()};
  }

 protected:
  openvdb::GridBase::ConstPtr grid_;
};

template <typename Grid>
class TypedGrid final : public AnyGrid {
 public:
  using AnyGrid::AnyGrid;

  double value(const VoxelIndex& at) const override { return tree().getValue(coord(at)); }
  bool is_active(const VoxelIndex& at) const override { return tree().isValueOn(coord(at)); }
  double background() const override { return tree().root().background(); }
  bool has_leaf(const VoxelIndex& at) const override { return tree().probeConstLeaf(coord(at)) != nullptr; }
  int value_depth(const VoxelIndex& at) const override { return tree().getValueDepth(coord(at)); }

  VdbType type() const override {
    using Value = typename Grid::ValueType;
    if constexpr (std::is_same_v<Value, bool>) return VdbType::kBool;
    return std::is_same_v<Value, float> ? VdbType::kFloat : VdbType::kDouble;
  }

  std::string level_set_faults(std::size_t checks) const override {
    if constexpr (std::is_same_v<typename Grid::ValueType, bool>) {
      return "not of numbers, but " + std::to_string(checks) + " checks wanted\n";
    } else {
      return openvdb::tools::checkLevelSet(static_cast<const Grid&>(*grid_), checks);
    }
  }

 private:
  const typename Grid::TreeType& tree() const { return static_cast<const typename Grid::TreeType&>(grid_->baseTree()); }
};

VdbGridPtr opened(const openvdb::GridBase::ConstPtr& grid) {
  if (grid->isType<openvdb::BoolGrid>()) return std::make_shared<TypedGrid<openvdb::BoolGrid>>(grid);
  if (grid->isType<openvdb::FloatGrid>()) return std::make_shared<TypedGrid<openvdb::FloatGrid>>(grid);
  if (grid->isType<openvdb::DoubleGrid>()) return std::make_shared<TypedGrid<openvdb::DoubleGrid>>(grid);
  throw std::runtime_error("grid '" + grid->getName() + "': another type of values");
}

openvdb::GridCPtrVec made(const std::vector<VdbGridToWrite>& grids) {
  using openvdb::FloatGrid;
  openvdb::initialize();
  openvdb::GridCPtrVec made;
  for (const VdbGridToWrite& grid : grids) {
    const openvdb::GridBase::Ptr base = openvdb::GridBase::createGrid(FloatGrid::gridType());
    base->setName(grid.name);
    base->setTransform(std::static_pointer_cast<openvdb::math::Transform>(grid.transform.held()));
    auto& tree = static_cast<FloatGrid::TreeType&>(base->baseTree());
    for (const VoxelIndex& at : grid.active) tree.setValue(coord(at), 1.0F);
    made.push_back(base);
  }
  return made;
}

openvdb::math::Transform& transform_of(const VdbTransform& transform) {
  return *static_cast<openvdb::math::Transform*>(transform.held().get());
}

}  // namespace

std::vector<VdbGridPtr> read_vdb_grids(const std::string& path) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(/*delayLoad=*/false);
  const openvdb::GridPtrVecPtr in_file = file.getGrids();
  std::vector<VdbGridPtr> grids;
  for (const openvdb::GridBase::Ptr& grid : *in_file) grids.push_back(opened(grid));
  return grids;
}

VdbGridPtr read_vdb_grid(const std::string& path, const std::string& name, VdbType type) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(/*delayLoad=*/false);
  const VdbGridPtr grid = opened(file.readGrid(name));
  return grid->type() == type ? grid : nullptr;
}

VdbTransform::VdbTransform(double voxel_size) : held_(openvdb::math::Transform::createLinearTransform(voxel_size)) {}

VdbTransform VdbTransform::frustum() {
  const openvdb::BBoxd box(openvdb::Vec3d(0), openvdb::Vec3d(10));
  VdbTransform transform;
  transform.held_ = openvdb::math::Transform::createFrustumTransform(box, /*taper=*/0.5, /*depth=*/10);
  return transform;
}

VdbTransform VdbTransform::affine(const std::array<double, 16>& matrix) {
  openvdb::initialize();
  const openvdb::math::AffineMap map(openvdb::Mat4d(matrix.data()));
  std::stringstream bytes;
  openvdb::writeString(bytes, map.type());
  map.write(bytes);
  openvdb::io::setCurrentVersion(bytes);
  VdbTransform transform;
  transform_of(transform).read(bytes);
  return transform;
}

VdbTransform& VdbTransform::translate(const Vec3& by) {
  transform_of(*this).postTranslate(vec3d(by));
  return *this;
}

VdbTransform& VdbTransform::scale(const Vec3& by) {
  transform_of(*this).postScale(vec3d(by));
  return *this;
}

VdbTransform& VdbTransform::rotate_about_x(double radians) {
  transform_of(*this).postRotate(radians, openvdb::math::X_AXIS);
  return *this;
}

void write_vdb_grids(const std::string& path, const std::vector<VdbGridToWrite>& grids, VdbStatistics statistics) {
  openvdb::io::File file(path);
  file.setGridStatsMetadataEnabled(statistics == VdbStatistics::kWith);
  file.write(made(grids));
}

void write_vdb_stream(const std::string& path, const std::vector<VdbGridToWrite>& grids) {
  std::ofstream file(path, std::ios::binary);
  openvdb::io::Stream(file).write(made(grids));
}

}  // namespace raycone::test
