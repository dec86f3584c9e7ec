#include "core/orientation/dipole_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace raycone {

DipoleTree::DipoleTree(std::vector<SurfaceDipole> dipoles, double reach)
    : dipoles_(std::move(dipoles)), signs_(dipoles_.size(), 1), order_(dipoles_.size()) {
  for (SurfaceDipole& dipole : dipoles_) dipole.radius = std::min(dipole.radius, reach);
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(order_.size()));
  set_signs(signs_);
}

void DipoleTree::build(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
  Box box = empty_box();
  for (std::uint32_t i = begin; i < end; ++i) extend(box, dipoles_[order_[i]].centre);
  SurfaceDipole sum;
  sum.centre = middle(box);
  for (std::uint32_t i = begin; i < end; ++i) {
    const SurfaceDipole& dipole = dipoles_[order_[i]];
    const Vec3 r = dipole.centre - sum.centre;
    sum.radius = std::max(sum.radius, std::sqrt(dot(r, r)) + dipole.radius);
  }
  nodes_[node].sum = sum;
  nodes_[node].begin = begin;
  nodes_[node].end = end;
  if (end - begin <= kLeaf) return;
  const int axis = longest_axis(box);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     return std::pair(dipoles_[a].centre[axis], a) < std::pair(dipoles_[b].centre[axis], b);
                   });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].children = children;
  nodes_.resize(nodes_.size() + 2);
  build(children, begin, middle);
  build(children + 1, middle, end);
}

void DipoleTree::set_signs(const std::vector<int>& signs) {
  signs_ = signs;
  // Children come behind their parents.
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    node.sum.area = {};
    if (node.children != 0) {
      node.sum.area = nodes_[node.children].sum.area + nodes_[node.children + 1].sum.area;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      node.sum.area = node.sum.area + signs_[order_[i]] * dipoles_[order_[i]].area;
    }
  }
}

double DipoleTree::far_sum(const Vec3& q) const { return far_sum(0, q); }

double DipoleTree::far_sum(std::uint32_t node, const Vec3& q) const {
  const Node& n = nodes_[node];
  if (is_far(n.sum, q)) return n.sum.at(q);
  if (n.children != 0) return far_sum(n.children, q) + far_sum(n.children + 1, q);
  double sum = 0.0;
  for (std::uint32_t i = n.begin; i < n.end; ++i) sum += signs_[order_[i]] * far_part(order_[i], q);
  return sum;
}

// A surface that is larger than it counts for may be near: no open surface winds much more than half a turn.
double DipoleTree::far_part(std::uint32_t surface, const Vec3& q) const {
  return is_far(dipoles_[surface], q) ? std::clamp(dipoles_[surface].at(q), -0.5, 0.5) : 0.0;
}

}  // namespace raycone
