#include "core/cells/plane_tolerance.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr double kVoxels = 1e-9, kMostVoxels = 0x1p-10;
// Text often has seven digits, or six behind the point.
constexpr double kDouble = 0x1p-50, kSingle = 0x1p-22, kText = 0x1p-20;

bool is_single(double x) { return std::abs(x) < 0x1p127 && static_cast<double>(static_cast<float>(x)) == x; }

// As text has it of numbers in single precision, or of others that it rounds.
bool has_few_digits(double x) {
  constexpr int kDigits = 9;
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.begin(), text.end(), x, std::chars_format::scientific, kDigits - 1).ptr;
  double same = 0.0;
  std::from_chars(text.begin(), end, same);
  return same == x;
}

// What numbers look like. Of many, the last one of them is what they all do.
enum Look : int { kLikeSingle, kLikeText, kLikeDouble };

Look look_of(double x) { return is_single(x) ? kLikeSingle : has_few_digits(x) ? kLikeText : kLikeDouble; }

// Of vertices [begin, end) that are used, and of those seen before.
int look_of(const TriangleMesh& mesh, const std::vector<std::uint8_t>& is_used, std::size_t begin, std::size_t end,
            int look) {
  for (std::size_t v = begin; v < end && look != kLikeDouble; ++v) {
    for (int axis = 0; axis < 3 && is_used[v] != 0; ++axis) {
      look = std::max<int>(look, look_of(mesh.vertices[v][axis]));
    }
  }
  return look;
}

// What used coordinates are rounded to, relative to the largest one.
double rounding_of(const TriangleMesh& mesh) {
  constexpr std::size_t kPerTask = 4096;
  std::vector<std::uint8_t> is_used(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) is_used[corner] = 1;
  }
  std::atomic<int> look = kLikeSingle;
  parallel_for(is_used.size(), kPerTask, [&](std::size_t begin, std::size_t end) {
    int known = look.load(std::memory_order_relaxed);
    const int here = look_of(mesh, is_used, begin, end, known);
    while (here > known && !look.compare_exchange_weak(known, here, std::memory_order_relaxed)) {
    }
  });
  return look == kLikeSingle ? kSingle : look == kLikeText ? kText : kDouble;
}

}  // namespace

double plane_tolerance(const TriangleMesh& mesh, const Lattice& lattice) {
  const double off = rounding_of(mesh) * largest_coordinate(bounding_box(mesh));
  return std::max(kVoxels, std::min(kMostVoxels, off / lattice.least_spacing())) * lattice.least_spacing();
}

double fine_tolerance(const Lattice& lattice) {
  return std::max(kVoxels * lattice.least_spacing(), kDouble * largest_coordinate(lattice));
}

}  // namespace raycone
