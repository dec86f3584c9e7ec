// libFuzzer target of the evaluator: bytes become a small mesh, queries and a lattice. Every engine must give each
// query the value of its definition (tests/property/check.h), and each sample of the lattice what it gives it as a
// point. Distances likewise (tests/property/distance_check.h). Rules hold for these values as their definitions say,
// and points drawn from the mesh lie on it (tests/property/check_samples.h).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "core/data/lattice.h"
#include "core/evaluation/winding_number.h"
#include "core/mesh/weld.h"
#include "tests/property/check.h"
#include "tests/property/check_samples.h"
#include "tests/property/distance_check.h"
#include "tests/support/lattice_samples.h"

namespace raycone {
namespace {

// The bytes as a sequence of choices; zeros where they have run out.
class Choices {
 public:
  explicit Choices(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::size_t below(std::size_t end) { return next<std::uint8_t>() % end; }

  // Of one of several kinds, so that ties are as likely as coordinates of any magnitude.
  double coordinate() {
    switch (below(4)) {
      case 0:
        return next<std::int8_t>() % 4;
      case 1:
        return next<std::int8_t>() / 16.0;
      case 2:
        return next<std::int16_t>() / 1024.0 + next<std::int8_t>() * 0x1p-40;
      default:
        // Magnitudes that the step by which the definition moves queries off the surface is small beside, also beside
        // their products: an edge may pass a query that much closer than any vertex.
        return std::ldexp(next<std::int32_t>(), -31 - 10 + static_cast<int>(below(21)));
    }
  }
  Vec3 point() {
    const double x = coordinate(), y = coordinate();
    return {x, y, coordinate()};
  }

 private:
  template <class Number>
  Number next() {
    std::array<std::uint8_t, sizeof(Number)> raw{};
    const std::size_t count = std::min(sizeof(Number), bytes_.size());
    std::memcpy(raw.data(), bytes_.data(), count);
    bytes_ = bytes_.subspan(count);
    return std::bit_cast<Number>(raw);
  }

  std::span<const std::uint8_t> bytes_;
};

TriangleMesh any_mesh(Choices& choices) {
  TriangleMesh mesh;
  for (std::size_t i = 3 + choices.below(12); i > 0; --i) mesh.vertices.push_back(choices.point());
  const std::size_t count = mesh.vertices.size();
  for (std::size_t i = 1 + choices.below(20); i > 0; --i) {
    Triangle triangle{};
    for (std::uint32_t& corner : triangle) corner = static_cast<std::uint32_t>(choices.below(count));
    mesh.triangles.push_back(triangle);
  }
  return weld(mesh, {});
}

// A point of its own, or one put together from the coordinates of vertices.
Vec3 any_query(const TriangleMesh& mesh, Choices& choices) {
  if (choices.below(2) == 0) return choices.point();
  const auto vertex = [&] { return mesh.vertices[choices.below(mesh.vertices.size())]; };
  const double x = vertex().x, y = vertex().y;
  return {x, y, vertex().z};
}

Lattice any_lattice(Choices& choices) {
  Lattice lattice;
  lattice.origin = choices.point();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lattice.spacing[static_cast<int>(axis)] = std::ldexp(1.0 + static_cast<double>(choices.below(4)), -2);
    lattice.index_min[axis] = -static_cast<std::int64_t>(choices.below(4));
    lattice.counts[axis] = 1 + static_cast<std::int64_t>(choices.below(5));
  }
  return lattice;
}

[[noreturn]] void report(const TriangleMesh& mesh, const test::Failure& failure) {
  std::fputs(test::describe(mesh, failure).c_str(), stderr);
  std::abort();
}

void check_rules(const TriangleMesh& mesh, const Vec3& point, double value) {
  if (const auto rule = test::check_rules(value))
    report(mesh, {point, *rule + " does not hold as its definition says"});
}

void check_lattice(const TriangleMesh& mesh, const Lattice& lattice) {
  const std::vector<Vec3> points = test::samples_of(lattice);
  std::vector<double> expected(points.size()), values(points.size());
  for (const Summation summation : {Summation::kCone, Summation::kTriangles}) {
    WindingNumberEvaluator(mesh, {.summation = summation}).evaluate(points, expected);
    for (std::size_t i = 0; i < points.size(); ++i) check_rules(mesh, points[i], expected[i]);
    for (const RayEngine engine : {RayEngine::kScan, RayEngine::kEmbree}) {
      WindingNumberEvaluator(mesh, {.ray_engine = engine, .summation = summation})
          .evaluate(lattice, whole(lattice), values);
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::bit_cast<std::uint64_t>(values[i]) == std::bit_cast<std::uint64_t>(expected[i])) continue;
        report(mesh, {points[i], "another value as a sample of a lattice"});
      }
    }
  }
}

void check_distances(const TriangleMesh& mesh, std::vector<Vec3> points, const Lattice& lattice) {
  test::DistanceCounts counts;
  const std::vector<Vec3> samples = test::samples_of(lattice);
  points.insert(points.end(), samples.begin(), samples.end());
  if (const auto failure = test::check_distances(mesh, points, counts)) report(mesh, *failure);
  if (const auto failure = test::check_lattice_distances(mesh, lattice, counts)) report(mesh, *failure);
}

}  // namespace
}  // namespace raycone

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace raycone;
  Choices choices({data, size});
  const TriangleMesh mesh = any_mesh(choices);
  std::vector<Vec3> queries;
  for (std::size_t i = 1 + choices.below(4); i > 0; --i) queries.push_back(any_query(mesh, choices));
  if (const auto failure = test::check(mesh, queries)) report(mesh, *failure);
  const Lattice lattice = any_lattice(choices);
  check_lattice(mesh, lattice);
  check_distances(mesh, queries, lattice);
  if (const auto failure = test::check_samples(mesh, choices.below(256), 4)) report(mesh, *failure);
  return 0;
}
