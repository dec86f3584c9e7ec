// The groups of faces that a mesh file names: groups and objects of OBJ, solids of STL, meshes of glTF, objects of 3MF.
#pragma once

#include <cstddef>
#include <cstdint>
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

// Bytes of a name that count: else a long name and many short lines could take any amount of memory.
inline constexpr std::size_t kMostOfName = 255;

// As many bytes of the name as count, without a part of a character of UTF-8 at the end.
[[nodiscard]] std::string cut_name(std::string_view name);

// Collects groups while a reader meets their faces.
class GroupCollector {
 public:
  // The triangles from `first` on, which does not decrease, belong to the group of this name.
  void continue_group(const std::string& name, std::size_t first) {
    const auto known = numbers_.try_emplace(cut_name(name), static_cast<std::uint32_t>(names_.size()));
    if (known.second) names_.push_back(known.first->first);
    add_run(first, known.first->second);
  }

  // The same, of a group of their own, whatever others are called.
  void start_group(const std::string& name, std::size_t first) {
    names_.push_back(cut_name(name));
    add_run(first, static_cast<std::uint32_t>(names_.size() - 1));
  }

  // Groups without triangles are left out. `triangles`: how many there are.
  [[nodiscard]] FaceGroups finish(std::size_t triangles) {
    if (!runs_.empty() && runs_.back().first == triangles) runs_.pop_back();
    constexpr std::uint32_t kUnknown = 0xFFFFFFFF;
    std::vector<std::uint32_t> number(names_.size(), kUnknown);
    FaceGroups groups;
    for (GroupRun run : runs_) {
      if (number[run.group] == kUnknown) {
        number[run.group] = static_cast<std::uint32_t>(groups.names.size());
        groups.names.push_back(std::move(names_[run.group]));
      }
      run.group = number[run.group];
      if (groups.runs.empty() || groups.runs.back().group != run.group) groups.runs.push_back(run);
    }
    return groups;
  }

 private:
  void add_run(std::size_t first, std::uint32_t group) {
    if (!runs_.empty() && runs_.back().first == first) runs_.pop_back();
    if (runs_.empty() || runs_.back().group != group) runs_.push_back({first, group});
  }

  std::unordered_map<std::string, std::uint32_t> numbers_;
  std::vector<std::string> names_;
  std::vector<GroupRun> runs_;
};

}  // namespace raycone
