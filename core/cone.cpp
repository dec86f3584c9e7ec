#include "core/cone.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "core/angle.h"
#include "core/exterior_edges.h"
#include "core/near_edge.h"
#include "core/predicates.h"
#include "core/tied_factor.h"

namespace raycone {
namespace {

constexpr std::size_t kTile = 64;  // samples whose products are carried along together; fits the first-level cache

using Tile = std::array<double, kTile>;

// Close to the inside of an edge s_a s_b and conj(P_a) P_b cancel; what is left must not be less than this share (rule
// 5).
constexpr double kNearEdge = 0x1p-8;
// |P|^2 within these bounds has lost nothing to underflow and cannot overflow.
constexpr double kSmallestSquare = 0x1p-800;
constexpr double kLargestSquare = 0x1p800;
// Factors within 2^+-kExponent can be multiplied kFactorsPerScaling times onto a number near 1.
constexpr double kSmallestFactor = 0x1p-120;
constexpr double kLargestFactor = 0x1p120;
constexpr int kFactorsPerScaling = 8;
// Beyond these even the scaling of a single factor could have lost bits.
constexpr double kSmallestScalable = 0x1p-900;
constexpr double kLargestScalable = 0x1p900;

// The power of two that brings `magnitude` (normal) into [1, 2).
double inverse_power(double magnitude) {
  constexpr std::uint64_t exponent_bits = 0x7FF0000000000000U;
  const std::uint64_t exponent = std::bit_cast<std::uint64_t>(magnitude) & exponent_bits;
  return std::bit_cast<double>((std::uint64_t{2046} << 52) - exponent);
}

// A vertex seen from a row: constant along it but for s.
struct Corner {
  Vec3 vertex;
  double y = 0.0;  // P
  double z = 0.0;
  double square = 0.0;  // |P|^2
  bool ordinary = false;
  Tile s;

  void look(const Vec3& v, const Row& row) {
    vertex = v;
    y = v.y - row.y;
    z = v.z - row.z;
    square = y * y + z * z;
    ordinary = square > kSmallestSquare && square < kLargestSquare;
    for (std::size_t i = 0; i < row.xs.size(); ++i) {
      const double x = v.x - row.xs[i];
      const double norm = std::sqrt(x * x + square);
      s[i] = x > 0.0 ? square / (norm + x) : norm - x;
    }
  }
};

// The product of the factors of one group at each sample, with the turns that it has completed.
struct Products {
  Tile re, im;
  std::array<std::int64_t, kTile> turns;
  int factors = 0;

  void reset(std::size_t samples) {
    std::fill_n(re.begin(), samples, 1.0);
    std::fill_n(im.begin(), samples, 0.0);
    std::fill_n(turns.begin(), samples, 0);
    factors = 0;
  }
};

// Multiplies onto Z; if both Im had one sign bit and the product's has the other, the argument has passed +-pi:
// rounding can neither create nor lose a turn (METHOD section 2).
inline void multiply(Products& z, std::size_t i, double re, double im) {
  const double product_re = z.re[i] * re - z.im[i] * im;
  const double product_im = z.re[i] * im + z.im[i] * re;
  const bool before = std::signbit(z.im[i]), factor = std::signbit(im), after = std::signbit(product_im);
  z.turns[i] += (before == factor && after != before) ? (before ? -1 : 1) : 0;
  z.re[i] = product_re;
  z.im[i] = product_im;
}

void scale(Products& z, std::size_t samples) {
  for (std::size_t i = 0; i < samples; ++i) {
    const double factor = inverse_power(std::max(std::abs(z.re[i]), std::abs(z.im[i])));
    z.re[i] *= factor;
    z.im[i] *= factor;
  }
  z.factors = 0;
}

// A factor that no cheap test vouches for.
Factor<double> careful_factor(const Corner& a, const Corner& b, const Vec3& q, double re, double im,
                              double product_of_s) {
  const double magnitude = std::abs(re) + std::abs(im);
  if (a.ordinary && b.ordinary && magnitude > kNearEdge * product_of_s && magnitude > kSmallestScalable &&
      magnitude < kLargestScalable) {
    const double power = inverse_power(magnitude);
    return {re * power, im * power};
  }
  const Factor<double> near = near_edge_factor<double>(a.vertex, b.vertex, q).factor;
  return {near.re, std::copysign(near.im, im)};
}

// Factors of an edge that no ray of the row's line ties with: D != 0.
void multiply_generic(Products& z, const Corner& a, const Corner& b, double im, const Row& row) {
  const double in_plane = a.y * b.y + a.z * b.z;
  const bool ordinary = a.ordinary && b.ordinary;
  Tile re, magnitude_excess;
  bool careful = !ordinary;
  for (std::size_t i = 0; i < row.xs.size(); ++i) {
    const double product_of_s = a.s[i] * b.s[i];
    re[i] = product_of_s + in_plane;
    const double magnitude = std::abs(re[i]) + std::abs(im);
    magnitude_excess[i] = std::min(magnitude - kNearEdge * product_of_s, magnitude - kSmallestFactor);
    // Written so that NaN is careful, too.
    careful |= !(magnitude_excess[i] > 0.0 && magnitude < kLargestFactor);
  }
  if (!careful) {
    for (std::size_t i = 0; i < row.xs.size(); ++i) multiply(z, i, re[i], im);
    return;
  }
  for (std::size_t i = 0; i < row.xs.size(); ++i) {
    const double magnitude = std::abs(re[i]) + std::abs(im);
    if (ordinary && magnitude_excess[i] > 0.0 && magnitude < kLargestFactor) {
      multiply(z, i, re[i], im);
    } else {
      const Factor<double> f = careful_factor(a, b, row.query(i), re[i], im, a.s[i] * b.s[i]);
      multiply(z, i, f.re, f.im);
    }
  }
}

void multiply_tied(Products& z, const Corner& a, const Corner& b, int side, const Row& row) {
  for (std::size_t i = 0; i < row.xs.size(); ++i) {
    const std::optional<Factor<double>> f = tied_factor<double>(a.vertex, b.vertex, row.query(i));
    if (!f) continue;
    const double power = inverse_power(std::max({std::abs(f->re), std::abs(f->im), 0x1p-1000}));
    multiply(z, i, f->re * power, std::copysign(f->im * power, side));
  }
}

void multiply_edge(Products& z, const Corner& a, const Corner& b, bool reversed, const Row& row) {
  const EdgeDeterminant d = edge_determinant(a.vertex, b.vertex, row.query(0));
  const EdgeSide side = edge_side(a.vertex, b.vertex, row.query(0), d);
  if (side.sign == 0) return;  // projects to a point: arg z = 0
  const int sign = reversed ? -side.sign : side.sign;
  if (side.tie) {
    multiply_tied(z, a, b, sign, row);
  } else {
    multiply_generic(z, a, b, std::copysign(d.value, sign), row);
  }
  if (++z.factors == kFactorsPerScaling) scale(z, row.xs.size());
}

}  // namespace

Cone::Cone(const TriangleMesh& mesh) {
  const std::vector<ExteriorEdge> edges = raycone::exterior_edges(mesh);
  edges_ = edges.size();
  const ExteriorEdge* previous = nullptr;
  for (const ExteriorEdge& e : edges) {
    const std::int32_t multiplicity = std::abs(e.multiplicity);
    if (groups_.empty() || groups_.back().multiplicity != multiplicity) {
      groups_.push_back({multiplicity, {}});
      previous = nullptr;
    }
    std::vector<Step>& steps = groups_.back().steps;
    if (!previous || previous->to != e.from) steps.push_back({mesh.vertices[e.from], false, false});
    steps.push_back({mesh.vertices[e.to], true, e.multiplicity < 0});
    previous = &e;
  }
}

void Cone::winding_numbers(const Row& row, std::span<Turns> cone) const {
  std::fill(cone.begin(), cone.end(), Turns{});
  for (std::size_t begin = 0; begin < row.xs.size(); begin += kTile) {
    const std::size_t samples = std::min(kTile, row.xs.size() - begin);
    const Row tile{row.y, row.z, row.xs.subspan(begin, samples)};
    for (const Group& group : groups_) {
      Products z;
      z.reset(samples);
      std::array<Corner, 2> corners;  // of the edge at hand, in turns
      std::size_t here = 0;
      for (const Step& step : group.steps) {
        here = 1 - here;
        corners[here].look(step.to, tile);
        if (step.joined) multiply_edge(z, corners[1 - here], corners[here], step.reversed, tile);
      }
      for (std::size_t i = 0; i < samples; ++i) {
        cone[begin + i].whole += group.multiplicity * z.turns[i];
        cone[begin + i].rest += group.multiplicity * argument_in_turns<double>(z.re[i], z.im[i]);
      }
    }
  }
}

}  // namespace raycone
