// Sums over the samples of lattices, by every way to cut a lattice.
#include "core/crossings/lattice_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "core/crossings/slab_order.h"
#include "core/data/lattice_slabs.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "core/mesh/exterior_edges.h"
#include "tests/support/diagnosed.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/lattice_samples.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::Diagnosed;

// --- The sums themselves

struct Said {
  std::size_t row;
  TriangleCrossing crossing;
};

std::vector<Said> random_statements(test::Random& random, std::size_t rows, std::size_t samples, std::size_t count) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  std::vector<Said> said;
  for (std::size_t n = 0; n < count; ++n) {
    TriangleCrossing c;
    c.sigma = random() % 2 == 0 ? 1 : -1;
    c.crossed = below(samples + 1);
    if (random() % 4 == 0) {
      c.ties = static_cast<int>(1 + random() % 2);
      c.met = below(samples + 1);
    }
    if (random() % 8 == 0) {
      c.on_begin = below(samples);
      c.on_end = c.on_begin + below(samples - c.on_begin + 1);
    }
    said.push_back({below(rows), c});
  }
  return said;
}

struct Sums {
  std::vector<std::int64_t> n, ties;
  std::vector<std::uint8_t> on_surface;
};

Sums by_definition(const std::vector<Said>& said, std::size_t rows, std::size_t samples) {
  Sums sums{std::vector<std::int64_t>(rows * samples), std::vector<std::int64_t>(rows * samples),
            std::vector<std::uint8_t>(rows * samples)};
  for (const auto& [row, c] : said) {
    for (std::size_t i = 0; i < samples; ++i) {
      const std::size_t at = row * samples + i;
      if (i < c.crossed) sums.n[at] += c.sigma;
      if (i < c.met) sums.ties[at] += c.ties;
      if (i >= c.on_begin && i < c.on_end) sums.on_surface[at] = 1;
    }
  }
  return sums;
}

void expect_sums(const std::vector<Said>& said, std::size_t rows, std::size_t samples, bool with_diagnostics) {
  const Sums expected = by_definition(said, rows, samples);
  std::vector<double> n(rows * samples, 7.0), bounds(rows * samples);
  std::vector<std::int64_t> crossings(rows * samples, 7), ties(rows * samples, 7);
  std::vector<std::uint8_t> on_surface(rows * samples, 1);
  const Diagnostics diagnostics{crossings, ties, on_surface, bounds};
  LatticeSums sums(rows, samples, n, with_diagnostics ? &diagnostics : nullptr);
  parallel_for(said.size(), 50, [&](std::size_t begin, std::size_t end) {
    LatticeSums::Collector collector(sums);
    for (std::size_t i = begin; i < end; ++i) collector.add(said[i].row, said[i].crossing);
    collector.finish();
  });
  sums.arrange();
  std::uint64_t on = 0;
  for (std::size_t row = 0; row < rows; ++row) on += sums.finish(row);

  EXPECT_EQ(on, static_cast<std::uint64_t>(std::ranges::count(expected.on_surface, 1)));
  std::uint64_t all_ties = 0;
  for (const std::int64_t t : expected.ties) all_ties += static_cast<std::uint64_t>(t);
  EXPECT_EQ(sums.ties(), all_ties);
  EXPECT_TRUE(std::ranges::equal(n, expected.n, [](double a, std::int64_t b) { return a == static_cast<double>(b); }));
  if (!with_diagnostics) return;
  EXPECT_EQ(crossings, expected.n);
  EXPECT_EQ(ties, expected.ties);
  EXPECT_EQ(on_surface, expected.on_surface);
}

void expect_runs(const std::vector<Said>& said, std::size_t rows, std::size_t samples, test::Random& random) {
  const std::vector<std::int64_t> expected = by_definition(said, rows, samples).n;
  LatticeSums sums(rows, samples);
  LatticeSums::Collector collector(sums);
  for (const auto& [row, crossing] : said) collector.add(row, crossing);
  collector.finish();
  sums.arrange();
  for (std::size_t row = 0; row < rows; ++row) {
    sums.finish(row);
    const RowRuns runs = sums.runs(row);
    const auto n = [&](std::size_t i) { return static_cast<double>(expected[row * samples + i]); };
    for (std::size_t i = 0; i < samples; ++i) ASSERT_EQ(runs.at(i), n(i));
    const std::size_t begin = random() % samples, end = begin + random() % (samples - begin + 1);
    std::size_t next = begin;
    EXPECT_TRUE(runs.for_each(begin, end, [&](std::size_t first, std::size_t last, double sum) {
      EXPECT_EQ(first, next);
      EXPECT_LT(first, last);
      for (std::size_t i = first; i < last; ++i) EXPECT_EQ(sum, n(i));
      next = last;
      return true;
    }));
    EXPECT_EQ(next, end);
    EXPECT_EQ(runs.for_each(begin, end, [](std::size_t, std::size_t, double) { return false; }), begin == end);
  }
}

TEST(LatticeSums, AreThoseOfTheDefinitionForFewAndForManyCrossings) {
  test::Random random(1);
  for (const std::size_t samples : {1U, 7U, 8U, 15U, 16U, 17U, 100U}) {
    for (const std::size_t count : {0U, 1U, 20U, 100U, 5000U}) {  // one in 16 samples is the most that is kept
      const std::vector<Said> said = random_statements(random, 30, samples, count);
      for (const bool with_diagnostics : {false, true}) {
        SCOPED_TRACE(testing::Message() << samples << " samples, " << count << " crossings, " << with_diagnostics);
        expect_sums(said, 30, samples, with_diagnostics);
      }
      expect_runs(said, 30, samples, random);
    }
  }
}

// --- Slabs

TriangleMesh sheets(int count) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const double x = i / static_cast<double>(count);
    test::add_triangle(mesh, {x, 0, 0}, {x, 1, 0}, {x, 0, 1});
  }
  return mesh;
}

// A flat square of n x n cells: half of its boundary runs along x.
TriangleMesh plate(int n) {
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      mesh.vertices.push_back({i / static_cast<double>(n), j / static_cast<double>(n), 0.25});
    }
  }
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

Diagnosed at_points(const WindingNumberEvaluator& evaluator, const Lattice& lattice) {
  return test::diagnosed(evaluator, test::samples_of(lattice));
}

// Slabs of a thickness across an axis, with diagnostics and without.
void expect_slabs(const WindingNumberEvaluator& evaluator, const Lattice& lattice, std::size_t axis,
                  std::int64_t thickness, const Diagnosed& expected) {
  Tally tally;
  for (std::int64_t done = 0; done < lattice.counts[axis]; done += thickness) {
    const LatticeBlock slab = slab_of(whole(lattice), axis, done, thickness);
    const Diagnosed with = test::diagnosed(evaluator, lattice, slab);
    tally += with.tally;
    std::vector<double> without(with.values.size());
    evaluator.evaluate(lattice, slab, without);
    ASSERT_EQ(with.values, without);
    std::size_t n = 0;
    for_each_sample(slab, [&](const LatticeIndex& index) {
      const std::size_t at = whole(lattice).number_of(index);
      ASSERT_EQ(with.values[n], expected.values[at]) << index[0] << ' ' << index[1] << ' ' << index[2];
      ASSERT_EQ(with.crossings[n], expected.crossings[at]);
      ASSERT_EQ(with.degenerate[n], expected.degenerate[at]);
      ASSERT_EQ(with.on_surface[n], expected.on_surface[at]);
      ASSERT_EQ(with.bounds[n], expected.bounds[at]);
      ++n;
    });
  }
  EXPECT_EQ(tally.degenerate, expected.tally.degenerate);
  EXPECT_EQ(tally.on_surface, expected.tally.on_surface);
}

std::vector<TriangleMesh> meshes_to_cut() {
  test::Random random(2);
  return {sheets(40),
          test::lattice_soup(random, 30, 3),
          test::soup(random, 20),
          test::random_cells(random, 3),
          test::open_box(),
          plate(3),
          test::sphere(4),
          test::assorted_triangles()};
}

TEST(LatticeSlabs, OfEveryAxisAndThicknessEqualPointsToTheBit) {
  Lattice lattice;
  lattice.origin = {-0.25, -0.25, -0.25};
  lattice.spacing = {0.125, 0.25, 0.1875};
  int shape = 0;
  for (const TriangleMesh& mesh : meshes_to_cut()) {
    const WindingNumberEvaluator evaluator(mesh);
    // Rows of one, of a few, of a tile and a rest; lattices flat along each axis.
    const std::array<std::array<std::int64_t, 3>, 4> shapes{{{17, 9, 8}, {1, 12, 11}, {70, 5, 1}, {9, 1, 9}}};
    lattice.counts = shapes[static_cast<std::size_t>(shape++) % shapes.size()];
    const Diagnosed expected = at_points(evaluator, lattice);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const std::int64_t thickness : {1, 2, 3, 100}) {
        SCOPED_TRACE(testing::Message() << "mesh " << shape << ", axis " << axis << ", thickness " << thickness);
        expect_slabs(evaluator, lattice, axis, thickness, expected);
      }
    }
  }
}

// --- The order of triangles across slabs

TEST(SlabOrder, MissesNoTriangleOfAnySlab) {
  test::Random random(3);
  TriangleMesh mesh = test::joined(test::soup(random, 500), test::assorted_triangles());
  mesh = test::joined(mesh, test::moved(test::soup(random, 3000), {0.01, 0.01, 0.01}, {0.3, 0.3, 0.3}));
  for (int axis = 0; axis < 3; ++axis) {
    const SlabOrder order(mesh, axis);
    std::vector<int> times(mesh.triangles.size());
    for (const std::uint32_t group : order.groups_in(-1e300, 1e300)) {
      for (const std::uint32_t triangle : order[group]) ++times[triangle];
    }
    EXPECT_TRUE(std::ranges::all_of(times, [](int n) { return n == 1; }));

    std::size_t looked_at = 0;
    for (double lower = -1.0; lower < 2.0; lower += 0.03) {
      std::set<std::uint32_t> found;
      for (const std::uint32_t group : order.groups_in(lower, lower + 0.01)) {
        found.insert(order[group].begin(), order[group].end());
      }
      looked_at += found.size();
      for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [least, most] =
            std::minmax({mesh.vertices[mesh.triangles[i][0]][axis], mesh.vertices[mesh.triangles[i][1]][axis],
                         mesh.vertices[mesh.triangles[i][2]][axis]});
        EXPECT_TRUE(least > lower + 0.01 || most < lower || found.contains(i)) << i;
      }
    }
    EXPECT_LT(looked_at, 100 * mesh.triangles.size() / 4) << "no slab is spared much";
  }
}

TEST(SlabOrder, TakesMeshesWithoutExtentAndOfAllOfTheRange) {
  const TriangleMesh flat = plate(2);
  EXPECT_EQ(SlabOrder(flat, 2).groups_in(0.25, 0.25).size(), 1U);
  EXPECT_TRUE(SlabOrder(flat, 2).groups_in(0.26, 1.0).empty());
  EXPECT_TRUE(SlabOrder({}, 1).groups_in(-1.0, 1.0).empty());
  const TriangleMesh huge = test::moved(test::open_box(), {1.7e308, 1.7e308, 1.7e308}, {-8e307, -8e307, -8e307});
  EXPECT_EQ(SlabOrder(huge, 1).groups_in(0.0, 0.0).size(), 1U);
}

// --- Edges along the rays

TEST(EdgesAlongX, ContributeNothingAndAreCounted) {
  const TriangleMesh mesh = plate(5);
  const WindingNumberEvaluator evaluator(mesh);
  EXPECT_EQ(evaluator.exterior_edges(), 20U);
  test::Random random(4);
  std::vector<Vec3> points;
  for (int n = 0; n < 200; ++n) points.push_back(test::uniform_point(random, {{-0.5, -0.5, -0.5}, {1.5, 1.5, 1.0}}));
  for (int n = 0; n < 20; ++n) points.push_back({-0.3 + 0.1 * n, 0.0, 0.3});  // above an edge along x
  const std::vector<double> values = test::values_of(evaluator, points);
  for (std::size_t n = 0; n < points.size(); ++n) {
    // Twenty edges, some u each; the oracle is good to 1e-14.
    EXPECT_NEAR(values[n], test::direct_winding_number(mesh, points[n]), 2e-14) << n;
  }
}

}  // namespace
}  // namespace raycone
