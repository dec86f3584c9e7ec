// The lattice of an OpenVDB grid: its transform, and the extent that raycone recorded or that its active voxels have.
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <vector>

#include "io/files/file_error.h"
#include "io/vdb/vdb_module.h"

namespace raycone {
namespace {

// The position in `names` of `wanted`, or of the first where that is empty.
std::size_t choose_grid(const std::string& path, const std::vector<std::string>& names, const std::string& wanted) {
  if (names.empty()) throw InputError(path + ": has no grids, expected one");
  if (wanted.empty()) return 0;
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  throw InputError(path + ": has no grid '" + wanted + "', expected one of: " + all);
}

// An entry of /proc/self/status, in bytes.
std::uint64_t status_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word && word != key) continue;
  std::uint64_t kilobytes = 0;
  status >> kilobytes;
  return kilobytes << 10;
}

// OpenVDB allocates whatever lengths a file announces. While this lives, this process cannot allocate more than what a
// true announcement of the file at `path` may lead to.
class MemoryForFile {
 public:
  explicit MemoryForFile(const std::string& path) {
    constexpr std::uint64_t kLibraries = std::uint64_t{64} << 20;  // their own needs, an arena of the allocator
    // The largest node: 32^3 tiles of 8 bytes, of which two masks of a bit each and little else need be in the file.
    constexpr std::uint64_t kMostPerByte = 64;
    const std::uint64_t more = kLibraries + kMostPerByte * std::filesystem::file_size(path);
    const std::uint64_t enough = status_bytes("VmData:") + more;
    rlimit space{};
    getrlimit(RLIMIT_AS, &space);
    getrlimit(RLIMIT_DATA, &before_);
    is_tightest_ = before_.rlim_cur > enough &&
                   (space.rlim_cur == RLIM_INFINITY || space.rlim_cur > status_bytes("VmSize:") + more);
    const rlimit limit{std::min(before_.rlim_cur, enough), before_.rlim_max};
    setrlimit(RLIMIT_DATA, &limit);
  }
  ~MemoryForFile() { setrlimit(RLIMIT_DATA, &before_); }
  MemoryForFile(const MemoryForFile&) = delete;
  MemoryForFile& operator=(const MemoryForFile&) = delete;

  // Whether allocations that fail meanwhile fail because of the file.
  [[nodiscard]] bool is_tightest() const { return is_tightest_; }

 private:
  rlimit before_{};
  bool is_tightest_ = false;
};

// Reads metadata and transform of a grid but not its tree. OpenVDB's File does that too, but returns a copy whose
// transform has been recomputed, with rounding errors (see transform_of in write_vdb.cpp).
class HeadReader : private openvdb::io::Archive {
 public:
  explicit HeadReader(const std::string& path) : path_(path), stream_(path, std::ios::binary) {
    stream_.exceptions(std::ios::eofbit | std::ios::failbit | std::ios::badbit);
    readHeader(stream_);
    setFormatVersion(stream_);
    setLibraryVersion(stream_);
    setDataCompression(stream_);
    openvdb::MetaMap().readMeta(stream_);
  }

  // Streams that were redirected into a file have no table of contents.
  [[nodiscard]] bool has_offsets() const { return inputHasGridOffsets(); }

  // Precondition: has_offsets().
  openvdb::GridBase::ConstPtr read(const std::string& wanted) {
    std::vector<openvdb::io::GridDescriptor> descriptors;
    std::vector<std::string> names;
    for (openvdb::Int32 remaining = readGridCount(stream_); remaining > 0; --remaining) {
      openvdb::io::GridDescriptor& descriptor = descriptors.emplace_back();
      descriptor.read(stream_);
      descriptor.seekToEnd(stream_);
      names.push_back(openvdb::io::GridDescriptor::nameAsString(descriptor.uniqueName()));
    }
    const openvdb::io::GridDescriptor& chosen = descriptors[choose_grid(path_, names, wanted)];
    chosen.seekToGrid(stream_);
    readGridCompression(stream_);
    const openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(chosen.gridType());
    grid->readMeta(stream_);
    grid->readTransform(stream_);
    grid->setName(chosen.gridName());
    return grid;
  }

 private:
  std::string path_;
  std::ifstream stream_;
};

// A grid with its tree.
openvdb::GridBase::ConstPtr read_whole(const std::string& path, const std::string& wanted) {
  openvdb::io::File file(path);
  file.setCopyMaxBytes(0);  // else small files are copied to the temporary directory first
  file.open();              // leaves' values stay on disk
  std::vector<std::string> names;
  for (auto name = file.beginName(); name != file.endName(); ++name) names.push_back(*name);
  return file.readGrid(names[choose_grid(path, names, wanted)]);
}

[[noreturn]] void fail(const std::string& path, const openvdb::GridBase& grid, const std::string& what) {
  throw InputError(path + ": grid '" + grid.getName() + "' " + what);
}

// Sets origin and spacing of `lattice`.
void read_transform(const std::string& path, const openvdb::GridBase& grid, Lattice& lattice) {
  const std::string expected = ", expected scale and translation only";
  if (!grid.constTransform().isLinear()) fail(path, grid, "has a frustum transform" + expected);
  // Row vectors: world = index * matrix.
  const openvdb::Mat4d matrix = grid.constTransform().baseMap()->getAffineMap()->getMat4();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (row != column && matrix(row, column) != 0.0) {
        fail(path, grid, "has a transform with rotation or shear" + expected);
      }
    }
    lattice.spacing[row] = matrix(row, row);
    lattice.origin[row] = matrix(3, row);
    if (!std::isfinite(lattice.spacing[row]) || !std::isfinite(lattice.origin[row])) {
      fail(path, grid, "has a transform that is not finite" + expected);
    }
    if (lattice.spacing[row] <= 0.0) fail(path, grid, "has a transform with negative scale" + expected);
  }
}

std::optional<openvdb::CoordBBox> box_metadata(const openvdb::GridBase& grid, const char* lower, const char* upper) {
  const auto min = grid.getMetadata<openvdb::Vec3IMetadata>(lower);
  const auto max = grid.getMetadata<openvdb::Vec3IMetadata>(upper);
  if (!min || !max) return std::nullopt;
  return openvdb::CoordBBox(openvdb::Coord(min->value()), openvdb::Coord(max->value()));
}

// The indices of all samples, ends included; empty where there are none. What the grid's head tells saves reading the
// tree, which takes time and, where the file is damaged, may crash OpenVDB.
openvdb::CoordBBox read_extent(const std::string& path, const openvdb::GridBase& head, const std::string& wanted) {
  if (const auto lattice = box_metadata(head, "raycone_index_min", "raycone_index_max")) return *lattice;
  const auto active = box_metadata(head, openvdb::GridBase::META_FILE_BBOX_MIN, openvdb::GridBase::META_FILE_BBOX_MAX);
  return active ? *active : read_whole(path, wanted)->evalActiveVoxelBoundingBox();
}

Lattice read(const std::string& path, const std::string& wanted) {
  HeadReader reader(path);
  const openvdb::GridBase::ConstPtr head = reader.has_offsets() ? reader.read(wanted) : read_whole(path, wanted);
  Lattice lattice;
  read_transform(path, *head, lattice);
  const openvdb::CoordBBox extent = read_extent(path, *head, wanted);
  if (extent.empty()) fail(path, *head, "has no active voxels, expected some, or a lattice recorded by raycone");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lattice.index_min[axis] = extent.min()[axis];
    lattice.counts[axis] = std::int64_t{extent.max()[axis]} - extent.min()[axis] + 1;
  }
  return lattice;
}

}  // namespace

Lattice vdb::read_lattice(const std::string& path, const std::string& name) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) {
    throw InputError(path + ": cannot read: " + (status ? status.message() : "not a regular file"));
  }
  openvdb::initialize();
  const MemoryForFile memory(path);
  try {
    return read(path, name);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    if (!memory.is_tightest()) throw;
    throw InputError(path + ": not a readable OpenVDB file: it announces more than it holds");
  } catch (const std::exception& error) {  // OpenVDB's own and the standard library's
    throw InputError(path + ": not a readable OpenVDB file: " + error.what());
  }
}

}  // namespace raycone
