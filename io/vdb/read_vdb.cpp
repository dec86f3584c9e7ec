// The lattice of an OpenVDB grid: its transform, and the extent that raycone recorded or that its active voxels have;
// and what its metadata say of how it was made.
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <vector>

#include "io/files/ascii.h"
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
  throw InputError(path + ": has no grid '" + wanted + "', expected one of: " + excerpt(all));
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
// true announcement of a file of `size` bytes may lead to.
class MemoryForFile {
 public:
  explicit MemoryForFile(std::uint64_t size) {
    constexpr std::uint64_t kLibraries = std::uint64_t{64} << 20;  // their own needs, an arena of the allocator
    // The largest node: 32^3 tiles of 24 bytes, a vector of doubles, of which two masks of a bit each and little else
    // need be in the file.
    constexpr std::uint64_t kMostPerByte = 128;
    const std::uint64_t more = kLibraries + kMostPerByte * size;
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

// "float" of "Tree_float_5_4_3"
std::string value_type(const std::string& grid_type) {
  const std::size_t begin = grid_type.find('_') + 1;
  return grid_type.substr(begin, grid_type.find('_', begin) - begin);
}

// Reads metadata and transforms of grids but not their trees. OpenVDB's File does that too, but returns copies whose
// transforms have been recomputed, with rounding errors (see transform_of in write_vdb.cpp).
class HeadReader : private openvdb::io::Archive {
 public:
  explicit HeadReader(const std::string& path) : stream_(path, std::ios::binary) {
    stream_.exceptions(std::ios::eofbit | std::ios::failbit | std::ios::badbit);
    readHeader(stream_);
    setFormatVersion(stream_);
    setLibraryVersion(stream_);
    setDataCompression(stream_);
    openvdb::MetaMap().readMeta(stream_);
    if (!has_offsets()) return;
    for (openvdb::Int32 remaining = readGridCount(stream_); remaining > 0; --remaining) {
      openvdb::io::GridDescriptor& descriptor = descriptors_.emplace_back();
      descriptor.read(stream_);
      descriptor.seekToEnd(stream_);
    }
  }

  // Streams that were redirected into a file have no table of contents, and nothing here.
  [[nodiscard]] bool has_offsets() const { return inputHasGridOffsets(); }

  // In the order of the file; no two are the same.
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const openvdb::io::GridDescriptor& descriptor : descriptors_) {
      names.push_back(openvdb::io::GridDescriptor::nameAsString(descriptor.uniqueName()));
    }
    return names;
  }

  openvdb::GridBase::ConstPtr head(std::size_t n) {
    const openvdb::io::GridDescriptor& descriptor = descriptors_[n];
    descriptor.seekToGrid(stream_);
    readGridCompression(stream_);
    const openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(descriptor.gridType());
    grid->readMeta(stream_);
    grid->readTransform(stream_);
    grid->setName(descriptor.gridName());
    return grid;
  }

 private:
  std::ifstream stream_;
  std::vector<openvdb::io::GridDescriptor> descriptors_;
};

// The grids of a file, in its order.
class GridsOfFile {
 public:
  explicit GridsOfFile(const std::string& path) : path_(path), heads_(path), names_(heads_.names()) {
    if (heads_.has_offsets()) return;
    whole_ = *opened()->getGrids();
    for (const openvdb::GridBase::Ptr& grid : whole_) names_.push_back(grid->getName());
  }

  [[nodiscard]] std::size_t count() const { return names_.size(); }
  // The number of the grid of that name, or of the first where it is empty.
  [[nodiscard]] std::size_t number_of(const std::string& wanted) const { return choose_grid(path_, names_, wanted); }

  // Metadata and transform, perhaps with the tree.
  [[nodiscard]] openvdb::GridBase::ConstPtr head(std::size_t n) {
    return heads_.has_offsets() ? heads_.head(n) : whole_[n];
  }
  // With the tree.
  [[nodiscard]] openvdb::GridBase::ConstPtr whole(std::size_t n) const {
    return heads_.has_offsets() ? opened()->readGrid(names_[n]) : whole_[n];
  }

 private:
  [[nodiscard]] std::unique_ptr<openvdb::io::File> opened() const {
    auto file = std::make_unique<openvdb::io::File>(path_);
    file->setCopyMaxBytes(0);  // else small files are copied to the temporary directory first
    file->open();              // leaves' values stay on disk, but for streams
    return file;
  }

  std::string path_;
  HeadReader heads_;
  std::vector<std::string> names_;
  openvdb::GridPtrVec whole_;  // of streams
};

[[noreturn]] void fail(const std::string& path, const openvdb::GridBase& grid, const std::string& what) {
  throw InputError(path + ": grid '" + excerpt(grid.getName()) + "' " + what);
}

// The transform, with the samples of `extent`.
PlacedLattice place(const std::string& path, const openvdb::GridBase& grid, const openvdb::CoordBBox& extent) {
  std::array<std::int64_t, 3> first{}, counts{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = extent.min()[axis];
    counts[axis] = std::int64_t{extent.max()[axis]} - extent.min()[axis] + 1;
  }
  // Row vectors: world = index * matrix.
  const openvdb::Mat4d matrix = grid.constTransform().baseMap()->getAffineMap()->getMat4();
  const auto row = [&](int n) { return Vec3{matrix(n, 0), matrix(n, 1), matrix(n, 2)}; };
  const PlacedLattice lattice(row(3), {row(0), row(1), row(2)}, first, counts);
  if (!lattice.is_finite()) fail(path, grid, "has a transform that is not finite, expected a finite one");
  if (!lattice.spans_space())
    fail(path, grid, "has a transform that flattens space, expected axes in three directions");
  return lattice;
}

std::optional<openvdb::CoordBBox> box_metadata(const openvdb::GridBase& grid, const char* lower, const char* upper) {
  const auto min = grid.getMetadata<openvdb::Vec3IMetadata>(lower);
  const auto max = grid.getMetadata<openvdb::Vec3IMetadata>(upper);
  if (!min || !max) return std::nullopt;
  return openvdb::CoordBBox(openvdb::Coord(min->value()), openvdb::Coord(max->value()));
}

// The indices of all samples of grid `n`, ends included; empty where there are none. What its head tells saves reading
// the tree, which takes time and, where the file is damaged, may crash OpenVDB.
openvdb::CoordBBox read_extent(const GridsOfFile& grids, std::size_t n, const openvdb::GridBase& head) {
  if (const auto lattice = box_metadata(head, "raycone_index_min", "raycone_index_max")) return *lattice;
  const auto active = box_metadata(head, openvdb::GridBase::META_FILE_BBOX_MIN, openvdb::GridBase::META_FILE_BBOX_MAX);
  return active ? *active : grids.whole(n)->evalActiveVoxelBoundingBox();
}

// Of grid `n`, with that head.
PlacedLattice lattice_of(const std::string& path, const GridsOfFile& grids, std::size_t n,
                         const openvdb::GridBase& head) {
  if (!head.constTransform().isLinear()) fail(path, head, "has a frustum transform, expected a linear one");
  const openvdb::CoordBBox extent = read_extent(grids, n, head);
  if (extent.empty()) fail(path, head, "has no active voxels, expected some, or a lattice recorded by raycone");
  return place(path, head, extent);
}

PlacedLattice read(const std::string& path, const std::string& wanted) {
  GridsOfFile grids(path);
  const std::size_t n = grids.number_of(wanted);
  return lattice_of(path, grids, n, *grids.head(n));
}

// --- How a grid was made --------------------------------------------------------------------------------------------

std::string rows_of(const openvdb::Mat4d& matrix) {
  std::string text = "[";
  for (int row = 0; row < 4; ++row) {
    text += row == 0 ? "[" : ", [";
    for (int column = 0; column < 4; ++column) {
      const double number = matrix(row, column);
      if (!std::isfinite(number)) return "null";
      text += (column == 0 ? "" : ", ") + shortest_text(number);
    }
    text += ']';
  }
  return text + ']';
}

// What write_vdb.cpp keeps, under the names that other formats have for it.
std::vector<MadeFact> how_made(const openvdb::GridBase& grid) {
  static constexpr std::array<std::array<const char*, 2>, 10> kKeys{{{"raycone_version", "raycone_version"},
                                                                     {"raycone_mesh", "mesh"},
                                                                     {"raycone_sha256", "sha256"},
                                                                     {"raycone_options", "options"},
                                                                     {"raycone_rule", "rule"},
                                                                     {"raycone_transform", "transform"},
                                                                     {"raycone_faces", "faces"},
                                                                     {"raycone_exterior_edges", "exterior_edges"},
                                                                     {"raycone_degenerate", "degenerate"},
                                                                     {"raycone_on_surface", "on_surface"}}};
  std::vector<MadeFact> facts;
  for (const auto& [key, name] : kKeys) {
    if (const auto text = grid.getMetadata<openvdb::StringMetadata>(key)) {
      facts.push_back({name, text->value()});
    } else if (const auto number = grid.getMetadata<openvdb::Int64Metadata>(key)) {
      facts.push_back({name, std::to_string(number->value()), true});
    } else if (const auto matrix = grid.getMetadata<openvdb::Mat4DMetadata>(key)) {
      facts.push_back({name, rows_of(matrix->value()), true});
    }
  }
  return facts;
}

// Adds what a grid says under `key`, unless another grid has told it.
void add_text(std::vector<MadeFact>& facts, const openvdb::GridBase& grid, const char* key, const char* name,
              bool is_json = false) {
  const auto text = grid.getMetadata<openvdb::StringMetadata>(key);
  const bool known = std::ranges::any_of(facts, [&](const MadeFact& fact) { return fact.key == name; });
  if (text && !known) facts.push_back({name, text->value(), is_json});
}

VolumeFacts facts_of(const std::string& path) {
  VolumeFacts facts;
  facts.format = "OpenVDB";
  GridsOfFile grids(path);
  const std::size_t first = grids.number_of("");
  openvdb::GridCPtrVec heads;
  for (std::size_t n = 0; n < grids.count(); ++n) heads.push_back(grids.head(n));
  facts.made = how_made(*heads[first]);
  std::string fields;
  for (const openvdb::GridBase::ConstPtr& head : heads) {
    facts.arrays.push_back({head->getName(), value_type(head->type())});
    // Only some fields have a rule, and all have the same; only one has labels.
    add_text(facts.made, *head, "raycone_rule", "rule");
    add_text(facts.made, *head, "raycone_labels", "labels", /*is_json=*/true);
    if (const auto field = head->getMetadata<openvdb::StringMetadata>("raycone_field")) {
      fields += (fields.empty() ? "" : " ") + field->value();
    }
  }
  if (!fields.empty()) facts.made.push_back({"fields", fields});
  set_lattice(facts, path, [&] { return lattice_of(path, grids, first, *heads[first]); });
  return facts;
}

// What `read_something` makes of the file; what OpenVDB throws as InputError.
template <typename Read>
auto read_file(const std::string& path, const Read& read_something) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) {
    throw InputError(path + ": cannot read: " + (status ? status.message() : "not a regular file"));
  }
  const std::uintmax_t size = std::filesystem::file_size(path, status);
  if (status) throw InputError(path + ": cannot read: " + status.message());
  openvdb::initialize();
  const MemoryForFile memory(size);
  try {
    return read_something();
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    if (!memory.is_tightest()) throw;
    throw InputError(path + ": not a readable OpenVDB file: it announces more than it holds");
  } catch (const std::ios_base::failure&) {
    throw InputError(path + ": not a readable OpenVDB file: it ends too early");
  } catch (const openvdb::Exception& error) {
    throw InputError(path + ": not a readable OpenVDB file: " + excerpt(error.what()));
  } catch (const std::exception&) {  // the standard library's, whose words tell nothing of the file
    throw InputError(path + ": not a readable OpenVDB file: it is damaged");
  }
}

}  // namespace

PlacedLattice vdb::read_lattice(const std::string& path, const std::string& name) {
  return read_file(path, [&] { return read(path, name); });
}

VolumeFacts vdb::read_facts(const std::string& path) {
  return read_file(path, [&] { return facts_of(path); });
}

}  // namespace raycone
