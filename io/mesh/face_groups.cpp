#include "io/mesh/face_groups.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace raycone {
namespace {

std::uint64_t hash_of(std::string_view text) { return std::hash<std::string_view>{}(text); }

// Of what was missing before and is missing now, in this order.
std::uint64_t joined(std::uint64_t before, std::uint64_t now) {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15;
  return (before + kOdd) * kOdd ^ now;
}

}  // namespace

std::string cut_name(std::string_view name) {
  if (name.size() < kMostOfName) return std::string(name);
  name = name.substr(0, kMostOfName);
  constexpr std::size_t kMostBytes = 4;  // of a character
  for (std::size_t back = 1; back < kMostBytes; ++back) {
    const auto byte = static_cast<unsigned char>(name[name.size() - back]);
    if ((byte & 0xC0U) == 0x80) continue;  // neither its first nor its only one
    const std::size_t bytes = byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : byte >= 0xC0 ? 2 : 1;
    if (bytes > back) name.remove_suffix(back);
    break;
  }
  return std::string(name);
}

void append_to_name(GroupName& name, std::string_view more) {
  const bool is_full = name.text.size() >= kMostOfName;
  const std::string_view kept = is_full ? std::string_view() : more.substr(0, kMostOfName);
  name.text += kept;
  if (kept.size() < more.size()) name.missing = joined(name.missing, hash_of(more.substr(kept.size())));
}

void append_to_name(GroupName& name, const GroupName& more) {
  append_to_name(name, more.text);
  if (more.missing != 0) name.missing = joined(name.missing, more.missing);
}

void GroupCollector::next(Named named) {
  close(named.first);
  GroupName& name = named.name;
  const std::string kept = cut_name(name.text);
  if (kept.size() < name.text.size()) {
    name.missing = joined(name.missing, hash_of(std::string_view(name.text).substr(kept.size())));
    name.text = kept;
  }
  last_ = std::move(named);
}

// The triangles up to `end` belong to the group that was named last.
void GroupCollector::close(std::size_t end) {
  if (!last_ || last_->first == end) return;
  const std::uint32_t group = number_of(*last_);
  if (groups_.runs.empty() || groups_.runs.back().group != group) groups_.runs.push_back({last_->first, group});
}

std::uint32_t GroupCollector::number_of(const Named& named) {
  const std::string& text = named.name.text;
  const std::uint64_t missing = named.name.missing;
  const std::uint64_t hash = joined(hash_of(text), missing);
  if (!named.is_own) {
    const auto [begin, end] = numbers_.equal_range(hash);
    const auto known = std::find_if(begin, end, [&](const auto& entry) {
      return groups_.names[entry.second] == text && missing_[entry.second] == missing;
    });
    if (known != end) return known->second;
  }
  const auto number = static_cast<std::uint32_t>(groups_.names.size());
  groups_.names.push_back(text);
  missing_.push_back(missing);
  if (!named.is_own) numbers_.emplace(hash, number);
  return number;
}

FaceGroups GroupCollector::finish(std::size_t triangles) {
  close(triangles);
  return std::move(groups_);
}

}  // namespace raycone
