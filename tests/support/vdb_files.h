// OpenVDB files as tests see them, in plain types: its headers take seconds to compile, and do so once, in
// vdb_files.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "core/data/vec3.h"

namespace raycone::test {

struct VoxelIndex {
  int x = 0, y = 0, z = 0;
};
inline std::ostream& operator<<(std::ostream& out, const VoxelIndex& at) {
  return out << '[' << at.x << ", " << at.y << ", " << at.z << ']';
}

// Of a row of CSV, which begins with the indices of its sample.
inline VoxelIndex voxel_of(const std::vector<double>& row) {
  return {static_cast<int>(row.at(0)), static_cast<int>(row.at(1)), static_cast<int>(row.at(2))};
}

enum class VdbType { kBool, kFloat, kDouble };

enum class VdbClass { kUnknown, kFogVolume, kLevelSet, kOther };

// A grid that has been read. All methods are OpenVDB's own answers.
class VdbGrid {
 public:
  virtual ~VdbGrid() = default;

  // Of a voxel; exact, whatever the type.
  [[nodiscard]] virtual double value(const VoxelIndex& at) const = 0;
  [[nodiscard]] virtual bool is_active(const VoxelIndex& at) const = 0;
  [[nodiscard]] virtual double background() const = 0;
  // Of the tree.
  [[nodiscard]] virtual std::uint64_t active_voxel_count() const = 0;
  [[nodiscard]] virtual std::uint64_t active_tile_count() const = 0;
  [[nodiscard]] virtual std::uint32_t leaf_count() const = 0;
  [[nodiscard]] virtual bool is_empty() const = 0;  // nothing but background
  [[nodiscard]] virtual bool has_leaf(const VoxelIndex& at) const = 0;
  [[nodiscard]] virtual int value_depth(const VoxelIndex& at) const = 0;  // 2: a tile of 8^3 voxels, 3: in a leaf
  // Of the head.
  [[nodiscard]] virtual VdbType type() const = 0;
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual VdbClass grid_class() const = 0;
  [[nodiscard]] virtual bool saves_as_half() const = 0;
  [[nodiscard]] virtual Vec3 position(const VoxelIndex& at) const = 0;
  [[nodiscard]] virtual Vec3 voxel_size() const = 0;
  [[nodiscard]] virtual bool has_uniform_scale() const = 0;
  [[nodiscard]] virtual bool has_transform_of(const VdbGrid& other) const = 0;
  // These but the first throw where there is no such metadata of that type.
  [[nodiscard]] virtual bool has_metadata(const std::string& key) const = 0;
  [[nodiscard]] virtual std::string text(const std::string& key) const = 0;
  [[nodiscard]] virtual std::int64_t integer(const std::string& key) const = 0;
  [[nodiscard]] virtual std::array<int, 3> index(const std::string& key) const = 0;
  // What openvdb::tools::checkLevelSet finds wrong in its first `checks` checks.
  [[nodiscard]] virtual std::string level_set_faults(std::size_t checks) const = 0;
};
using VdbGridPtr = std::shared_ptr<const VdbGrid>;

// All grids of a file, in its order. Throws where it has grids of other types than VdbType.
[[nodiscard]] std::vector<VdbGridPtr> read_vdb_grids(const std::string& path);

// The grid of that name; null where it is not of that type. Throws where there is none.
[[nodiscard]] VdbGridPtr read_vdb_grid(const std::string& path, const std::string& name,
                                       VdbType type = VdbType::kFloat);

// --- Files as other programs write them

// From index to world space, made by OpenVDB's own means.
class VdbTransform {
 public:
  // Cubic voxels, the first at the origin.
  explicit VdbTransform(double voxel_size = 1.0);
  [[nodiscard]] static VdbTransform frustum();
  // Stored as a matrix, which VdbTransform(...) would not be: rows of four, for row vectors.
  [[nodiscard]] static VdbTransform affine(const std::array<double, 16>& matrix);

  VdbTransform& translate(const Vec3& by);
  VdbTransform& scale(const Vec3& by);
  VdbTransform& rotate_about_x(double radians);

  // An openvdb::math::Transform.
  [[nodiscard]] const std::shared_ptr<void>& held() const { return held_; }

 private:
  std::shared_ptr<void> held_;
};

// A grid of floats, 1 at the active voxels.
struct VdbGridToWrite {
  std::string name;
  VdbTransform transform;
  std::vector<VoxelIndex> active;
};

enum class VdbStatistics { kWithout, kWith };

void write_vdb_grids(const std::string& path, const std::vector<VdbGridToWrite>& grids,
                     VdbStatistics statistics = VdbStatistics::kWith);
// Without the table of contents.
void write_vdb_stream(const std::string& path, const std::vector<VdbGridToWrite>& grids);

}  // namespace raycone::test
