#include "core/surface/nearest_triangle.h"

#include <algorithm>
#include <numeric>

namespace raycone {
namespace {

constexpr std::uint32_t kLeaf = 4;

}  // namespace

NearestTriangle::NearestTriangle(const TriangleMesh& mesh)
    : scale_(-largest_exponent(mesh)), order_(mesh.triangles.size()) {
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = scale_(mesh.vertices[t[0]]), b = scale_(mesh.vertices[t[1]]), c = scale_(mesh.vertices[t[2]]);
    triangles_.emplace_back(a, b, c);
    boxes_.push_back(box_of(a, b, c));
  }
  std::iota(order_.begin(), order_.end(), 0U);
  build(0, static_cast<std::uint32_t>(order_.size()));
}

void NearestTriangle::build(std::uint32_t begin, std::uint32_t end) {
  const std::size_t number = branches_.size();
  Box box = boxes_[order_[begin]];
  for (std::uint32_t n = begin + 1; n < end; ++n) extend(box, boxes_[order_[n]]);
  branches_.push_back({box, begin, end, 0});
  if (end - begin > kLeaf) {
    const Vec3 side = box.upper - box.lower;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const auto rank = [&](std::uint32_t t) { return std::pair(boxes_[t].lower[axis] + boxes_[t].upper[axis], t); };
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](std::uint32_t s, std::uint32_t t) { return rank(s) < rank(t); });
    build(begin, middle);
    build(middle, end);
  }
  branches_[number].next = static_cast<std::uint32_t>(branches_.size());
}

std::uint32_t NearestTriangle::of(const Vec3& point, std::uint32_t guess) const {
  const Vec3 p = scale_(point);
  std::pair best(triangles_[guess].squared(p), guess);
  for (std::size_t n = 0; n < branches_.size();) {
    const Branch& branch = branches_[n];
    if (square_of_gap(branch.box, p) > beyond_error(best.first)) {
      n = branch.next;
      continue;
    }
    if (branch.end - branch.begin <= kLeaf) {
      for (std::uint32_t i = branch.begin; i < branch.end; ++i) {
        best = std::min(best, std::pair(triangles_[order_[i]].squared(p), order_[i]));
      }
    }
    ++n;
  }
  return best.second;
}

}  // namespace raycone
