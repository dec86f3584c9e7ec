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

// "float" of "Tree_float_5_4_3"
std::string value_type(const std::string& grid_type) {
  const std::size_t begin = grid_type.find('_') + 1;
  return grid_type.substr(begin, grid_type.find('_', begin) - begin);
}

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

  // Precondition: has_offsets(). All heads are added to `all`, where given.
  openvdb::GridBase::ConstPtr read(const std::string& wanted, openvdb::GridCPtrVec* all = nullptr) {
    std::vector<openvdb::io::GridDescriptor> descriptors;
    std::vector<std::string> names;
    for (openvdb::Int32 remaining = readGridCount(stream_); remaining > 0; --remaining) {
      openvdb::io::GridDescriptor& descriptor = descriptors.emplace_back();
      descriptor.read(stream_);
      descriptor.seekToEnd(stream_);
      names.push_back(openvdb::io::GridDescriptor::nameAsString(descriptor.uniqueName()));
    }
    const std::size_t chosen = choose_grid(path_, names, wanted);
    for (std::size_t n = 0; all && n < descriptors.size(); ++n) all->push_back(head_of(descriptors[n]));
    return head_of(descriptors[chosen]);
  }

 private:
  openvdb::GridBase::ConstPtr head_of(const openvdb::io::GridDescriptor& descriptor) {
    descriptor.seekToGrid(stream_);
    readGridCompression(stream_);
    const openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(descriptor.gridType());
    grid->readMeta(stream_);
    grid->readTransform(stream_);
    grid->setName(descriptor.gridName());
    return grid;
  }

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

// The indices of all samples, ends included; empty where there are none. What the grid's head tells saves reading the
// tree, which takes time and, where the file is damaged, may crash OpenVDB.
openvdb::CoordBBox read_extent(const std::string& path, const openvdb::GridBase& head, const std::string& wanted) {
  if (const auto lattice = box_metadata(head, "raycone_index_min", "raycone_index_max")) return *lattice;
  const auto active = box_metadata(head, openvdb::GridBase::META_FILE_BBOX_MIN, openvdb::GridBase::META_FILE_BBOX_MAX);
  return active ? *active : read_whole(path, wanted)->evalActiveVoxelBoundingBox();
}

// Of the head of grid `wanted`.
PlacedLattice lattice_of(const std::string& path, const openvdb::GridBase& head, const std::string& wanted) {
  if (!head.constTransform().isLinear()) fail(path, head, "has a frustum transform, expected a linear one");
  const openvdb::CoordBBox extent = read_extent(path, head, wanted);
  if (extent.empty()) fail(path, head, "has no active voxels, expected some, or a lattice recorded by raycone");
  return place(path, head, extent);
}

PlacedLattice read(const std::string& path, const std::string& wanted) {
  HeadReader reader(path);
  const openvdb::GridBase::ConstPtr head = reader.has_offsets() ? reader.read(wanted) : read_whole(path, wanted);
  return lattice_of(path, *head, wanted);
}

// --- How a grid was made

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

// Of all grids.
openvdb::GridCPtrVec read_heads(const std::string& path) {
  openvdb::GridCPtrVec heads;
  HeadReader reader(path);
  if (reader.has_offsets()) {
    (void)reader.read("", &heads);
    return heads;
  }
  openvdb::io::File file(path);
  file.setCopyMaxBytes(0);
  file.open();
  for (const openvdb::GridBase::Ptr& grid : *file.readAllGridMetadata()) heads.push_back(grid);
  if (heads.empty()) throw InputError(path + ": has no grids, expected one");
  heads.front() = read_whole(path, "");
  return heads;
}

VolumeFacts facts_of(const std::string& path) {
  VolumeFacts facts;
  facts.format = "OpenVDB";
  const openvdb::GridCPtrVec heads = read_heads(path);
  facts.made = how_made(*heads.front());
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
  try {
    facts.lattice = lattice_of(path, *heads.front(), "");
  } catch (const InputError& error) {
    facts.no_lattice = std::string(error.what()).substr(path.size() + 2);
  }
  return facts;
}

// What `read_something` makes of the file; what OpenVDB throws as InputError.
template <typename Read>
auto read_file(const std::string& path, const Read& read_something) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) {
    throw InputError(path + ": cannot read: " + (status ? status.message() : "not a regular file"));
  }
  openvdb::initialize();
  const MemoryForFile memory(path);
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
