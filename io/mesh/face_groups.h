// The groups of faces that a mesh file names: groups and objects of OBJ, solids of STL, meshes of glTF, objects of 3MF.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace raycone {

// The triangles from `first` on, up to those of the next run, belong to a group.
struct GroupRun {
  std::uint64_t first = 0;
  std::uint32_t group = 0;

  friend bool operator==(const GroupRun&, const GroupRun&) = default;
};

struct FaceGroups {
  std::vector<std::string> names;  // in the order of their first triangles; each has one. "": the file names it not
  std::vector<GroupRun> runs;      // the first of them starts at triangle 0; empty where a format has no groups
};

// Bytes of a name that are kept: else a long name and many short lines could take any amount of memory.
inline constexpr std::size_t kMostOfName = 255;

// As many bytes of the name as are kept, without a part of a character of UTF-8 at the end.
[[nodiscard]] std::string cut_name(std::string_view name);

// A name, and a hash of what was cut off it: that tells apart those that begin alike. 0 where nothing was.
struct GroupName {
  std::string text;
  std::uint64_t missing = 0;

  friend bool operator==(const GroupName&, const GroupName&) = default;
};

// Adds `more` to a name, whose text stays below twice kMostOfName.
void append_to_name(GroupName& name, std::string_view more);
void append_to_name(GroupName& name, const GroupName& more);

// Collects groups while a reader meets their faces. Those without triangles leave nothing behind.
class GroupCollector {
 public:
  // The triangles from `first` on, which does not decrease, belong to the group of this name.
  void continue_group(GroupName name, std::size_t first) { next({std::move(name), first, false}); }

  // The same, of a group of their own, whatever others are called.
  void start_group(std::string_view name, std::size_t first) { next({{cut_name(name)}, first, true}); }

  // `triangles`: how many there are.
  [[nodiscard]] FaceGroups finish(std::size_t triangles);

 private:
  struct Named {
    GroupName name;
    std::size_t first;
    bool is_own;
  };

  void next(Named named);
  void close(std::size_t end);
  [[nodiscard]] std::uint32_t number_of(const Named& named);

  std::optional<Named> last_;
  FaceGroups groups_;
  std::vector<std::uint64_t> missing_;                             // of their names
  std::unordered_multimap<std::uint64_t, std::uint32_t> numbers_;  // by hashes of names; none of start_group()
};

}  // namespace raycone
