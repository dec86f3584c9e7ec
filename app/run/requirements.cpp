#include "app/run/requirements.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "app/report/info.h"
#include "core/mesh/mesh_flaws.h"
#include "io/files/ascii.h"
#include "io/files/counted.h"
#include "io/files/enumerated.h"

namespace raycone {
namespace {

// "face 3", "faces 3 and 17", "faces 3, 17 and 5 more"
std::string named_faces(const std::vector<std::uint32_t>& faces) {
  constexpr std::size_t kMostNamed = 2;
  std::vector<std::string> numbers;
  for (const std::uint32_t face : faces) numbers.push_back(std::to_string(face));
  return (faces.size() == 1 ? "face " : "faces ") + enumerated(first_words(std::move(numbers), kMostNamed), " and ");
}

class Judgement {
 public:
  Judgement(const TriangleMesh& mesh, const MeshStatistics& statistics, const MeshDefects& defects,
            const FoundIntersections& intersections)
      : mesh_(mesh), statistics_(statistics), defects_(defects), intersections_(intersections) {}

  // What is wrong and where; empty where nothing is.
  std::string of(Requirement requirement) {
    switch (requirement) {
      case Requirement::kClosed:
        return closed("closed");
      case Requirement::kOriented:
        return edges("oriented", statistics_.inconsistent_edges, "inconsistent edge", &EdgeUse::is_inconsistent);
      case Requirement::kOutward:
        return outward();
      case Requirement::kManifold:
        return edges("manifold", statistics_.nonmanifold_edges, "non-manifold edge", &EdgeUse::is_nonmanifold);
      case Requirement::kEmbedded:
        return embedded();
      case Requirement::kNoDuplicates:
        return no_duplicates();
    }
    return "";
  }

 private:
  std::string edges(const std::string& word, std::uint64_t count, const std::string& what,
                    bool (EdgeUse::*is_flawed)() const) {
    if (count == 0) return "";
    if (flawed_.empty()) flawed_ = flawed_edges(mesh_);
    const auto edge = std::ranges::find_if(flawed_, [&](const EdgeUse& use) { return (use.*is_flawed)(); });
    if (edge == flawed_.end()) return word + ": " + counted(count, what);
    return word + ": " + counted(count, what) + ", the first from " + printed_point(mesh_.vertices[edge->low]) +
           " to " + printed_point(mesh_.vertices[edge->high]) + " of " + named_faces(triangles_at(mesh_, *edge));
  }

  std::string closed(const std::string& word) {
    return edges(word, statistics_.exterior_edges, "exterior edge", &EdgeUse::is_exterior);
  }

  std::string outward() {
    if (!statistics_.closed()) return closed("outward");
    if (defects_.negative_volume) {
      return "outward: the signed volume is negative, " + with_digits(statistics_.signed_volume.value_or(0.0), 9);
    }
    if (defects_.reversed_components == 0) return "";
    return "outward: " + counted(defects_.reversed_components, "outermost component") + " of negative volume";
  }

  [[nodiscard]] std::string embedded() const {
    if (!intersections_.first) return "";
    const auto [low, high] = *intersections_.first;
    const std::string faces = "faces " + std::to_string(low) + " and " + std::to_string(high);
    if (!intersections_.pairs) return "embedded: " + faces + " intersect";
    return "embedded: " + counted(*intersections_.pairs, "pair") + " of faces that intersect, the first " + faces;
  }

  [[nodiscard]] std::string no_duplicates() const {
    if (statistics_.duplicate_faces == 0) return "";
    const std::array<std::uint32_t, 2> pair = first_duplicate(mesh_).value_or(std::array<std::uint32_t, 2>{});
    return "no-duplicates: " + counted(statistics_.duplicate_faces, "duplicate face") + ", the first " +
           std::to_string(pair[1]) + " of face " + std::to_string(pair[0]);
  }

  const TriangleMesh& mesh_;
  const MeshStatistics& statistics_;
  const MeshDefects& defects_;
  const FoundIntersections& intersections_;
  std::vector<EdgeUse> flawed_;  // once one is asked for
};

}  // namespace

std::string unmet_requirements(const std::vector<Requirement>& required, const TriangleMesh& mesh,
                               const MeshStatistics& statistics, const MeshDefects& defects,
                               const FoundIntersections& intersections) {
  Judgement judgement(mesh, statistics, defects, intersections);
  std::string unmet;
  for (const Requirement requirement : required) {
    const std::string one = judgement.of(requirement);
    if (!one.empty()) unmet += (unmet.empty() ? "" : "; ") + one;
  }
  return unmet;
}

}  // namespace raycone
