#include "core/projected_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycone {
namespace {

// To float, monotone; what floats cannot hold is as good as their end.
float to_float(double x) { return static_cast<float>(std::clamp(x, -1e38, 1e38)); }
// Farther out by more than the rounding.
float rounded_down(double x) { return to_float(x) - std::abs(to_float(x)) * 0x1p-22F - 1e-37F; }
float rounded_up(double x) { return to_float(x) + std::abs(to_float(x)) * 0x1p-22F + 1e-37F; }

// The bits of v in the even places.
std::uint32_t spread(std::uint32_t v) {
  v &= 0xFFFFU;
  v = (v | (v << 8)) & 0x00FF00FFU;
  v = (v | (v << 4)) & 0x0F0F0F0FU;
  v = (v | (v << 2)) & 0x33333333U;
  return (v | (v << 1)) & 0x55555555U;
}

// [lower, upper] to 0 .. 2^bits - 1, monotone and clamped.
std::uint32_t quantized(double x, double lower, double upper, int bits) {
  const double place = (x - lower) / (upper - lower) * std::ldexp(1.0, bits);
  return place > 0.0 ? static_cast<std::uint32_t>(std::min(place, std::ldexp(1.0, bits) - 1)) : 0;
}

struct Extent {
  double lower, upper;
};

Extent extent_of(const TriangleMesh& mesh, const Triangle& t, int axis) {
  const auto [lower, upper] =
      std::minmax({mesh.vertices[t[0]][axis], mesh.vertices[t[1]][axis], mesh.vertices[t[2]][axis]});
  return {lower, upper};
}

// Sorts keys by their upper 32 bits (the lower ones are indices), least significant digit first.
void sort_keys(std::vector<std::uint64_t>& keys) {
  constexpr int kDigitBits = 11;
  std::vector<std::uint64_t> other(keys.size());
  for (int shift = 32; shift < 64; shift += kDigitBits) {
    std::array<std::size_t, (1U << kDigitBits) + 1> begin{};
    const auto digit = [&](std::uint64_t key) { return (key >> shift) & ((1U << kDigitBits) - 1); };
    for (const std::uint64_t key : keys) ++begin[digit(key) + 1];
    for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    for (const std::uint64_t key : keys) other[begin[digit(key)]++] = key;
    keys.swap(other);
  }
}

}  // namespace

void ProjectedTree::Node::clear() {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  lower_y.fill(infinity);
  upper_y.fill(-infinity);
  lower_z.fill(infinity);
  upper_z.fill(-infinity);
  upper_x.fill(-infinity);
}

ProjectedTree::ProjectedTree(const TriangleMesh& mesh) : box_(bounding_box(mesh)) { build(mesh); }

// 28 bits.
std::uint32_t ProjectedTree::curve(double y, double z) const {
  constexpr int kBits = 14;
  return spread(quantized(y, box_.lower.y, box_.upper.y, kBits)) |
         (spread(quantized(z, box_.lower.z, box_.upper.z, kBits)) << 1);
}

void ProjectedTree::build(const TriangleMesh& mesh) {
  const double size = std::max(box_.upper.y - box_.lower.y, box_.upper.z - box_.lower.z);
  std::vector<std::uint64_t> keys(mesh.triangles.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Extent y = extent_of(mesh, mesh.triangles[i], 1), z = extent_of(mesh, mesh.triangles[i], 2);
    // Classes differ by factors of sixteen in size, so that one large triangle does not spoil the boxes of small ones.
    const int exponent = std::ilogb(std::max({y.upper - y.lower, z.upper - z.lower, size * 0x1p-30}) / size);
    const auto size_class = static_cast<std::uint64_t>(std::clamp(-exponent / 4, 0, 15));
    const std::uint32_t place = curve(0.5 * y.lower + 0.5 * y.upper, 0.5 * z.lower + 0.5 * z.upper);
    keys[i] = (size_class << 60) | (std::uint64_t{place} << 32) | i;
  }
  sort_keys(keys);
  triangles_.resize(keys.size());
  Level leaves((keys.size() + kWidth - 1) / kWidth);
  for (Node& node : leaves) node.clear();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    triangles_[i] = static_cast<std::uint32_t>(keys[i]);
    const Triangle& t = mesh.triangles[triangles_[i]];
    const Extent y = extent_of(mesh, t, 1), z = extent_of(mesh, t, 2);
    Node& node = leaves[i / kWidth];
    node.lower_y[i % kWidth] = rounded_down(y.lower);
    node.upper_y[i % kWidth] = rounded_up(y.upper);
    node.lower_z[i % kWidth] = rounded_down(z.lower);
    node.upper_z[i % kWidth] = rounded_up(z.upper);
    node.upper_x[i % kWidth] = rounded_up(extent_of(mesh, t, 0).upper);
  }
  levels_.push_back(std::move(leaves));
  while (levels_.back().size() > 1) {
    const Level& below = levels_.back();
    Level level((below.size() + kWidth - 1) / kWidth);
    for (Node& node : level) node.clear();
    for (std::size_t i = 0; i < below.size(); ++i) {
      Node& node = level[i / kWidth];
      const Node& child = below[i];
      node.lower_y[i % kWidth] = *std::min_element(child.lower_y.begin(), child.lower_y.end());
      node.upper_y[i % kWidth] = *std::max_element(child.upper_y.begin(), child.upper_y.end());
      node.lower_z[i % kWidth] = *std::min_element(child.lower_z.begin(), child.lower_z.end());
      node.upper_z[i % kWidth] = *std::max_element(child.upper_z.begin(), child.upper_z.end());
      node.upper_x[i % kWidth] = *std::max_element(child.upper_x.begin(), child.upper_x.end());
    }
    levels_.push_back(std::move(level));
  }
}

std::size_t ProjectedTree::place(const Vec3& origin) const { return curve(origin.y, origin.z) >> 12; }

// To nearest: the boxes are rounded outward, which is monotone.
ProjectedTree::Rays ProjectedTree::ray(const Vec3& origin) {
  const float y = to_float(origin.y), z = to_float(origin.z);
  return {to_float(origin.x), y, y, z, z};
}

// Rays that are farther apart meet so many nodes together that each is better off alone.
bool ProjectedTree::share_descent(const Rays& rays) const {
  constexpr double kClose = 1.0 / 64;  // of the mesh's box
  return rays.upper_y - rays.lower_y <= kClose * (box_.upper.y - box_.lower.y) &&
         rays.upper_z - rays.lower_z <= kClose * (box_.upper.z - box_.lower.z);
}

}  // namespace raycone
