#include "app/samples/slice_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "app/process/usage_error.h"
#include "app/samples/lattice_choice.h"
#include "io/files/ascii.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// Axes to the right and up of pictures across x, y, z: seen from +x, -y, +z.
constexpr std::array<std::pair<int, int>, 3> kAxesInPlane{{{1, 2}, {0, 2}, {0, 1}}};

// Normals this close to z (sine of the angle) have y as up.
constexpr double kNoUp = 1e-3;

Vec3 unit(int axis) {
  Vec3 v;
  v[axis] = 1.0;
  return v;
}

// Scaled first: squares of large and small components overflow and vanish.
Vec3 normalized(const Vec3& v) {
  const double largest = largest_coordinate(v);
  const Vec3 scaled{v.x / largest, v.y / largest, v.z / largest};
  return (1.0 / std::sqrt(dot(scaled, scaled))) * scaled;
}

double position_of(const AxisPlane& plane, const Box& box) {
  if (const auto* at = std::get_if<double>(&plane.at)) return *at;
  const double part = std::get<Percentage>(plane.at).value / 100.0;
  const double lower = box.lower[plane.axis];
  const double upper = box.upper[plane.axis];
  const double at = part == 1.0 ? upper : lower + part * (upper - lower);  // which may round to beyond the end
  if (!std::isfinite(at)) throw LimitError("the box is too large for double precision; see --scale");
  return at;
}

// The picture would be blank.
void refuse_outside(const AxisPlane& plane, double at, const Box& box) {
  const double lower = box.lower[plane.axis];
  const double upper = box.upper[plane.axis];
  if (lower <= at && at <= upper) return;
  const auto* percentage = std::get_if<Percentage>(&plane.at);
  const std::string asked =
      percentage ? shortest_text(percentage->value) + "% (" + shortest_text(at) + ")" : shortest_text(at);
  throw UsageError("--at " + asked + ": outside the box, expected " + shortest_text(lower) + " to " +
                   shortest_text(upper) + "; see --bounds and --padding");
}

void add_pixels(std::int64_t& count, std::int64_t padding) {
  constexpr std::int64_t kMost = std::int64_t{1} << 40;
  if (padding < -kMost || padding > kMost)
    throw LimitError("--padding " + std::to_string(padding) + "v: too many pixels");
  count += 2 * padding;
  if (count < 1) throw UsageError("--padding " + std::to_string(padding) + "v: leaves no pixel");
}

std::int64_t pixels_of(const SliceRequest& request) {
  const auto* padding = std::get_if<VoxelPadding>(&request.padding);
  return padding ? padding->samples : 0;
}

// The pixels are a lattice with one layer.
Lattice lattice_across(int axis, double at, Box box, const SliceRequest& request) {
  box.lower[axis] = at;
  box.upper[axis] = at;
  std::vector<Warning> none;  // a flat side is what is asked for
  const LatticeRequest pixels{
      .bounds = box, .padding = WorldPadding{}, .sampling = LongestSide{request.size}, .centers = true};
  Lattice lattice = choose_lattice(box, pixels, none);
  const auto [right, up] = kAxesInPlane[static_cast<std::size_t>(axis)];
  for (const int in_plane : {right, up}) {
    const auto a = static_cast<std::size_t>(in_plane);
    add_pixels(lattice.counts[a], pixels_of(request));
    lattice.index_min[a] -= pixels_of(request);
  }
  return lattice;
}

PlaneView view_of(const Lattice& lattice, int axis) {
  const auto [right, up] = kAxesInPlane[static_cast<std::size_t>(axis)];
  PlaneView view;
  view.pixel = lattice.spacing[right];
  for (int a = 0; a < 3; ++a) view.corner[a] = lattice.coordinate(a, lattice.index_min[static_cast<std::size_t>(a)]);
  view.corner[right] -= view.pixel / 2;
  view.corner[up] -= view.pixel / 2;
  view.right = unit(right);
  view.up = unit(up);
  view.normal = cross(view.right, view.up);
  view.width = lattice.counts[static_cast<std::size_t>(right)];
  view.height = lattice.counts[static_cast<std::size_t>(up)];
  return view;
}

std::string listed(const Vec3& v, int digits) {
  return with_digits(v.x, digits) + ',' + with_digits(v.y, digits) + ',' + with_digits(v.z, digits);
}

Slice choose(const AxisPlane& plane, const Box& box, const Box& padded, const SliceRequest& request) {
  const double at = position_of(plane, box);
  refuse_outside(plane, at, padded);
  Slice slice;
  slice.lattice = lattice_across(plane.axis, at, padded, request);
  slice.view = view_of(*slice.lattice, plane.axis);
  slice.plane = std::string(1, "xyz"[plane.axis]) + " = " + with_digits(at + 0.0, 6);  // never -0
  slice.short_plane = slice.plane;
  const auto [right, up] = kAxesInPlane[static_cast<std::size_t>(plane.axis)];
  slice.is_flat = padded.lower[right] == padded.upper[right] || padded.lower[up] == padded.upper[up];
  return slice;
}

// Directions of the picture in the plane.
void set_directions(PlaneView& view, const ObliquePlane& plane) {
  view.normal = normalized(plane.normal);
  const bool across_z = std::hypot(view.normal.x, view.normal.y) < kNoUp;
  const Vec3 up = normalized(plane.up.value_or(across_z ? unit(1) : unit(2)));
  const Vec3 in_plane = up - dot(up, view.normal) * view.normal;
  if (std::sqrt(dot(in_plane, in_plane)) < 1e-9) throw UsageError("--up: is the direction of --normal");
  view.up = normalized(in_plane);
  view.right = cross(view.up, view.normal);
}

std::array<Vec3, 8> corners_of(const Box& box) {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] = {(i & 1U) != 0 ? box.upper.x : box.lower.x, (i & 2U) != 0 ? box.upper.y : box.lower.y,
                  (i & 4U) != 0 ? box.upper.z : box.lower.z};
  }
  return corners;
}

// Where the plane cuts the edges of the box; nowhere where it passes by.
std::vector<Vec3> cut(const Box& box, const Vec3& origin, const Vec3& normal) {
  const std::array<Vec3, 8> corners = corners_of(box);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < 8; ++i) {
    for (const std::size_t step : {1U, 2U, 4U}) {
      if ((i & step) != 0) continue;
      const Vec3& a = corners[i];
      const Vec3& b = corners[i + step];
      const double from = dot(normal, a - origin);
      const double to = dot(normal, b - origin);
      if (from == 0.0) points.push_back(a);
      if (to == 0.0) points.push_back(b);
      if ((from < 0.0) != (to < 0.0)) points.push_back(a + (from / (from - to)) * (b - a));
    }
  }
  return points;
}

// A point of the plane that is not far from the box, in which pixels have their digits: `origin` unless that is far.
Vec3 near_point(const Box& box, const Vec3& origin, const Vec3& normal) {
  const Vec3 sides = box.upper - box.lower, middle = box.lower + 0.5 * sides;
  const double longest = longest_side(box);
  for (int axis = 0; axis < 3; ++axis) {
    const double farthest = sides[axis] / 2 + longest;
    if (!(std::abs(origin[axis] - middle[axis]) <= farthest)) return middle - dot(normal, middle - origin) * normal;
  }
  return origin;
}

// Pixels that cover an outline in the plane. `near`: a point of the plane, not far from these. Returns whether the
// outline is flat.
bool set_pixels(PlaneView& view, const std::vector<Vec3>& outline, const Vec3& near, const SliceRequest& request) {
  const auto along_right = [&](const Vec3& p) { return dot(p - near, view.right); };
  const auto along_up = [&](const Vec3& p) { return dot(p - near, view.up); };
  const auto [left, right] = std::ranges::minmax(outline, {}, along_right);
  const auto [bottom, top] = std::ranges::minmax(outline, {}, along_up);
  const double width = along_right(right) - along_right(left);
  const double height = along_up(top) - along_up(bottom);
  if (!std::isfinite(width) || !std::isfinite(height)) {
    throw LimitError("the box is too large for double precision; see --scale");
  }
  const double longer = std::max(width, height);
  view.pixel = longer > 0.0 ? longer / static_cast<double>(request.size) : 1.0;
  if (!(view.pixel > 0.0)) throw LimitError("the pixels are too small for double precision; see --scale");
  const auto pixels = [&](double side) {
    return std::max<std::int64_t>(std::llround(std::ceil(side / view.pixel - kRoundingSlack)), 1);
  };
  view.width = pixels(width);
  view.height = pixels(height);
  const std::int64_t padding = pixels_of(request);
  add_pixels(view.width, padding);
  add_pixels(view.height, padding);
  const double margin = static_cast<double>(padding) * view.pixel;
  view.corner = near + (along_right(left) - margin) * view.right + (along_up(bottom) - margin) * view.up;
  return width == 0.0 || height == 0.0;
}

Slice choose(const ObliquePlane& plane, const Box& box, const Box& padded, const SliceRequest& request) {
  Slice slice;
  PlaneView& view = slice.view;
  set_directions(view, plane);
  const Vec3 origin = plane.origin.value_or(box.lower + 0.5 * (box.upper - box.lower));
  view.origin = origin;
  const std::vector<Vec3> outline = cut(padded, origin, view.normal);
  if (outline.empty()) throw UsageError("--origin, --normal: the plane misses the box, see --bounds and --padding");
  slice.is_flat = set_pixels(view, outline, near_point(padded, origin, view.normal), request);
  slice.plane = "normal " + listed(view.normal, 6) + " through " + listed(origin, 6);
  slice.short_plane = "normal " + listed(view.normal, 3) + " at " + listed(origin, 3);
  return slice;
}

}  // namespace

Slice choose_slice(const Box& mesh_box, const SliceRequest& request, std::vector<Warning>& warnings) {
  const Box box = request.bounds.value_or(mesh_box);
  const auto* padding = std::get_if<WorldPadding>(&request.padding);
  const Box padded = padding ? widened(box, *padding) : box;
  Slice slice = std::visit([&](const auto& plane) { return choose(plane, box, padded, request); }, request.plane);
  if (slice.is_flat && (slice.view.width == 1 || slice.view.height == 1)) {
    warnings.push_back({"flat-box", "the box is flat: the picture is " + std::to_string(slice.view.width) + " x " +
                                        std::to_string(slice.view.height) + " pixels; see --padding"});
  }
  return slice;
}

}  // namespace raycone
