#include "core/orientation/patches.h"

#include <algorithm>
#include <utility>

#include "core/orientation/canonical_face.h"

namespace raycone {
namespace {

constexpr std::uint32_t kNoPatch = 0xFFFFFFFF;

class PatchFinder {
 public:
  PatchFinder(const std::vector<Triangle>& faces, const FaceNeighbours& neighbours, const std::vector<Vec3>& vertices)
      : faces_(faces), neighbours_(neighbours), vertices_(vertices) {}

  Patches find() {
    patches_.sign.assign(faces_.size(), 0);
    number_patches([](std::uint32_t, const FaceNeighbour&) { return true; });
    if (const std::vector<std::size_t> contradictory = contradictory_patches(); !contradictory.empty()) {
      for (const std::size_t patch : contradictory) turn_with_few_cuts(patch);
      number_patches([this](std::uint32_t face, const FaceNeighbour& other) { return agree(face, other); });
    }
    return std::move(patches_);
  }

 private:
  [[nodiscard]] bool agree(std::uint32_t face, const FaceNeighbour& other) const {
    return patches_.sign[face] * patches_.sign[other.face] == other.agrees;
  }

  template <class Visit>
  void for_each_neighbour(std::uint32_t face, const Visit& visit) const {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      if (const FaceNeighbour other = neighbours_.neighbour(face, corner); other.agrees != 0) visit(other);
    }
  }

  // Joins neighbours for which joins() holds; faces without a sign get one on the way.
  template <class Joins>
  void number_patches(const Joins& joins) {
    patches_.of_face.assign(faces_.size(), kNoPatch);
    patches_.faces.clear();
    patches_.faces.reserve(faces_.size());
    patches_.begin.assign(1, 0);
    for (std::uint32_t start = 0; start < faces_.size(); ++start) {
      if (patches_.of_face[start] != kNoPatch) continue;
      const auto patch = static_cast<std::uint32_t>(patches_.size());
      std::size_t next = patches_.faces.size();
      patches_.of_face[start] = patch;
      if (patches_.sign[start] == 0) patches_.sign[start] = 1;
      for (patches_.faces.push_back(start); next < patches_.faces.size(); ++next) {
        const std::uint32_t face = patches_.faces[next];
        for_each_neighbour(face, [&](const FaceNeighbour& other) {
          if (patches_.of_face[other.face] != kNoPatch || !joins(face, other)) return;
          patches_.of_face[other.face] = patch;
          std::int8_t& sign = patches_.sign[other.face];
          if (sign == 0) sign = static_cast<std::int8_t>(patches_.sign[face] * other.agrees);
          patches_.faces.push_back(other.face);
        });
      }
      patches_.begin.push_back(next);
    }
    count_cut_edges();
  }

  void count_cut_edges() {
    std::uint64_t twice = 0;
    for (std::uint32_t face = 0; face < faces_.size(); ++face) {
      for_each_neighbour(face, [&](const FaceNeighbour& other) { twice += !agree(face, other); });
    }
    patches_.cut_edges = twice / 2;
  }

  [[nodiscard]] std::vector<std::size_t> contradictory_patches() const {
    std::vector<std::size_t> found;
    for (std::size_t patch = 0; patches_.cut_edges > 0 && patch < patches_.size(); ++patch) {
      const std::span<const std::uint32_t> of_patch = patches_[patch];
      const bool contradicts = std::any_of(of_patch.begin(), of_patch.end(), [&](std::uint32_t face) {
        bool all = true;
        for_each_neighbour(face, [&](const FaceNeighbour& other) { all = all && agree(face, other); });
        return !all;
      });
      if (contradicts) found.push_back(patch);
    }
    return found;
  }

  // By coordinates: what is cut must not depend on the order in the file.
  [[nodiscard]] std::vector<std::uint32_t> in_order(std::span<const std::uint32_t> of_patch) const {
    using Place = std::pair<CanonicalFace, std::uint32_t>;
    std::vector<Place> places;
    for (const std::uint32_t face : of_patch) places.push_back({canonical_face(faces_[face], vertices_), face});
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.first < b.first; });
    std::vector<std::uint32_t> ordered;
    for (const Place& place : places) ordered.push_back(place.second);
    return ordered;
  }

  void turn_with_few_cuts(std::size_t patch) {
    const std::vector<std::uint32_t> ordered = in_order(patches_[patch]);
    if (rank_.empty()) rank_.resize(faces_.size());
    for (std::uint32_t i = 0; i < ordered.size(); ++i) {
      rank_[ordered[i]] = i;
      patches_.sign[ordered[i]] = 0;
    }
    spread(ordered);
    turn_singly(ordered);
  }

  // Breadth first from the first face, so that cuts lie where the fronts meet.
  void spread(const std::vector<std::uint32_t>& ordered) {
    std::vector<std::uint32_t> reached{ordered.front()};
    patches_.sign[ordered.front()] = 1;
    for (std::size_t next = 0; next < reached.size(); ++next) {
      const std::size_t first = reached.size();
      for_each_neighbour(reached[next], [&](const FaceNeighbour& other) {
        std::int8_t& sign = patches_.sign[other.face];
        if (sign != 0) return;
        sign = static_cast<std::int8_t>(patches_.sign[reached[next]] * other.agrees);
        reached.push_back(other.face);
      });
      std::sort(reached.begin() + static_cast<std::ptrdiff_t>(first), reached.end(),
                [&](std::uint32_t a, std::uint32_t b) { return rank_[a] < rank_[b]; });
    }
  }

  // Turns faces at which more edges are cut than not. Each turn shortens the cut, so that this ends; the limit keeps
  // the time in proportion.
  void turn_singly(const std::vector<std::uint32_t>& ordered) {
    constexpr int kMaxPasses = 64;  // far more than cuts take to straighten
    bool turned = true;
    for (int pass = 0; turned && pass < kMaxPasses; ++pass) {
      turned = false;
      for (const std::uint32_t face : ordered) {
        int balance = 0;
        for_each_neighbour(face, [&](const FaceNeighbour& other) { balance += agree(face, other) ? 1 : -1; });
        if (balance >= 0) continue;
        patches_.sign[face] = static_cast<std::int8_t>(-patches_.sign[face]);
        turned = true;
      }
    }
  }

  const std::vector<Triangle>& faces_;
  const FaceNeighbours& neighbours_;
  const std::vector<Vec3>& vertices_;
  std::vector<std::uint32_t> rank_;  // of the faces of patches that are cut, along their order
  Patches patches_;
};

}  // namespace

Patches find_patches(const std::vector<Triangle>& faces, const FaceNeighbours& neighbours,
                     const std::vector<Vec3>& vertices) {
  return PatchFinder(faces, neighbours, vertices).find();
}

}  // namespace raycone
