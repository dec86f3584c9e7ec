// The interface of all engines of winding numbers. What they differ in is the boundary term: what there is between the
// winding number w and the number n of triangles that a ray crosses, which is exact.
#pragma once

#include <cstdint>
#include <span>

#include "core/boundary/boundary.h"
#include "core/boundary/sample_tile.h"

namespace raycone {

// An engine: the winding numbers of one open mesh, tile by tile. It promises one of two things:
//
// - Complete engines (CompleteEngine) sum up all that there is, in an order that the mesh alone gives. A value is off
//   by rounding, and by nothing else.
// - Bounded engines leave out what they can bound. That bound is part of doubt().
//
// Both give a query the same bits in any tile, on any thread, at any SIMD level, and w on the surface and at ties is
// that of the perturbed query (core/exact/predicates.h). Calls may run concurrently; they need DefaultFloatingPoint.
class WindingNumberEngine {
 public:
  WindingNumberEngine() = default;
  WindingNumberEngine(const WindingNumberEngine&) = delete;
  WindingNumberEngine& operator=(const WindingNumberEngine&) = delete;
  virtual ~WindingNumberEngine() = default;

  // Whether values depend on n. Where not, nobody needs to count crossings.
  [[nodiscard]] virtual bool counts_crossings() const = 0;

  // Sets w[i] to the winding number at sample i, whose ray has n = crossings[i]; any number where these do not count.
  // Both spans are as long as the tile, which holds at least one sample.
  virtual void winding_numbers(SampleTile& samples, std::span<const std::int64_t> crossings,
                               std::span<double> w) const = 0;

  // No value is off by more, turns, but for its last rounding to double, which moves none past a critical value of a
  // rule (docs/method.md, "Rules"); at most Boundary::kMostDoubt. Closer to a critical value than this, a value is to
  // be settled (Boundary::settle()).
  [[nodiscard]] virtual double doubt() const = 0;
};

// How far the argument of a product may be off, turns. `edge_factors`: how many edges' factors round in it, with their
// multiplicities; a triangle counts as three.
[[nodiscard]] double doubt_of_factors(double edge_factors);

// What complete engines have in common: each factor rounds by a bounded number of turns.
class CompleteEngine : public WindingNumberEngine {
 public:
  [[nodiscard]] double doubt() const final { return doubt_; }

 protected:
  // As doubt_of_factors() says. `boundary` must outlive this.
  CompleteEngine(const Boundary& boundary, double edge_factors);

  [[nodiscard]] const Boundary& boundary() const { return boundary_; }

 private:
  const Boundary& boundary_;
  double doubt_;
};

}  // namespace raycone
