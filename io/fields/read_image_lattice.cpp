// Heads as teem.sourceforge.net/nrrd/format.html and nifti1.h describe them. Nothing but the head is read.
#include "io/fields/read_image_lattice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/files/byte_order.h"
#include "io/files/file_error.h"
#include "io/files/input_buffer.h"
#include "io/files/unpack.h"

namespace raycone {
namespace {

constexpr std::string_view kNrrd = "NRRD000";
constexpr std::size_t kNiftiHead = 348;

// World = origin + the sum of index times step, over the axes.
struct Placement {
  std::array<Vec3, 3> steps;
  Vec3 origin;
  std::array<std::int64_t, 3> counts{};
};

[[noreturn]] void fail_image(const std::string& path, const std::string& what) {
  throw InputError(path + ": not a readable volume: " + what);
}

InputBuffer open_volume(const std::string& path) { return InputBuffer(path, unpacked(open_source(path), path)); }

// --- NRRD -----------------------------------------------------------------------------------------------------------

using Entries = std::map<std::string, std::string, std::less<>>;

// "key: value" up to the empty line that ends the head.
Entries read_nrrd_entries(const std::string& path) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  InputBuffer input = open_volume(path);
  const auto end = [&] { return std::min(input.pending().find("\n\n"), input.pending().find("\n\r\n")); };
  while (end() == std::string_view::npos && input.pending().size() < kMostBytes && input.fill()) continue;
  Entries entries;
  std::string_view text = input.pending().substr(0, end());
  if (text.size() >= kMostBytes) fail_image(path, "its head has no end");
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::size_t colon = line.find(": ");
    if (colon == std::string_view::npos || line.starts_with('#')) continue;
    entries.emplace(line.substr(0, colon), line.substr(colon + 2));
  }
  return entries;
}

// The numbers in `text`, whatever parentheses, commas and blanks stand between; of other text, none.
template <std::size_t kCount>
std::array<double, kCount> read_numbers_of(const std::string& path, const Entries& entries, const std::string& key) {
  const auto found = entries.find(key);
  if (found == entries.end()) fail_image(path, "it has no " + key);
  std::array<double, kCount> numbers{};
  const char* at = found->second.data();
  const char* const end = at + found->second.size();
  const auto skip = [&] {
    while (at < end && std::string_view("(), \t\r").find(*at) != std::string_view::npos) ++at;
  };
  const auto fail = [&] { fail_image(path, key + ", expected " + std::to_string(kCount) + " numbers"); };
  for (double& number : numbers) {
    skip();
    const auto [after, error] = std::from_chars(at, end, number);
    if (error != std::errc() || !std::isfinite(number)) fail();
    at = after;
  }
  skip();
  if (at != end) fail();
  return numbers;
}

// Which way x and y point: 1 as ours, -1 the other way.
double nrrd_turn(const std::string& path, const Entries& entries) {
  const auto space = entries.find("space");
  const std::string name = space == entries.end() ? "" : space->second;
  if (name == "right-anterior-superior" || name == "RAS") return 1.0;
  if (name == "left-posterior-superior" || name == "LPS") return -1.0;
  fail_image(path, "its space, expected right-anterior-superior or left-posterior-superior");
}

Placement read_nrrd(const std::string& path) {
  const Entries entries = read_nrrd_entries(path);
  if (read_numbers_of<1>(path, entries, "dimension")[0] != 3.0) fail_image(path, "its dimension, expected 3");
  const double turn = nrrd_turn(path, entries);
  const auto sizes = read_numbers_of<3>(path, entries, "sizes");
  const auto steps = read_numbers_of<9>(path, entries, "space directions");
  const auto origin = read_numbers_of<3>(path, entries, "space origin");
  Placement placement;
  const auto turned = [turn](double x, double y, double z) { return Vec3{turn * x, turn * y, z}; };
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(sizes[a] >= 1.0) || sizes[a] > 0x1p53 || sizes[a] != std::floor(sizes[a])) {
      fail_image(path, "sizes, expected whole numbers of at least 1");
    }
    placement.counts[a] = static_cast<std::int64_t>(sizes[a]);
    placement.steps[a] = turned(steps[3 * a], steps[3 * a + 1], steps[3 * a + 2]);
  }
  placement.origin = turned(origin[0], origin[1], origin[2]);
  return placement;
}

// --- NIfTI-1 --------------------------------------------------------------------------------------------------------

// The byte order of a head, by its first number; nothing where it is none.
std::optional<std::endian> nifti_order(std::string_view head) {
  if (head.size() < kNiftiHead || (head.substr(344, 3) != "n+1" && head.substr(344, 3) != "ni1")) return std::nullopt;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    if (load<std::int32_t>(head.data(), order) == kNiftiHead) return order;
  }
  return std::nullopt;
}

// By method 2 of nifti1.h: a quaternion, of which b, c and d are stored.
std::array<Vec3, 3> quaternion_steps(double b, double c, double d, const Vec3& spacing, double mirror) {
  const double a = std::sqrt(std::max(0.0, 1.0 - (b * b + c * c + d * d)));
  return {spacing.x * Vec3{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
          spacing.y * Vec3{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
          mirror * spacing.z * Vec3{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c}};
}

Placement read_nifti(const std::string& path) {
  InputBuffer input = open_volume(path);
  while (input.pending().size() < kNiftiHead && input.fill()) continue;
  const std::string_view head = input.pending();
  const std::optional<std::endian> order = nifti_order(head);
  if (!order) fail_image(path, "its head is damaged");
  const auto integer = [&](std::size_t offset) { return load<std::int16_t>(&head[offset], *order); };
  const auto real = [&](std::size_t offset) { return static_cast<double>(load<float>(&head[offset], *order)); };
  Placement placement;
  if (integer(40) < 3) fail_image(path, "its dimension, expected at least 3");
  for (std::size_t a = 0; a < 3; ++a) placement.counts[a] = integer(42 + 2 * a);
  if (integer(254) > 0) {
    for (std::size_t a = 0; a < 3; ++a) {
      placement.steps[a] = {real(280 + 4 * a), real(296 + 4 * a), real(312 + 4 * a)};
      placement.origin[static_cast<int>(a)] = real(280 + 16 * a + 12);
    }
  } else if (integer(252) > 0) {
    const double mirror = real(76) < 0.0 ? -1.0 : 1.0;
    placement.steps = quaternion_steps(real(256), real(260), real(264), {real(80), real(84), real(88)}, mirror);
    placement.origin = {real(268), real(272), real(276)};
  } else {
    fail_image(path, "it has neither sform nor qform, expected a place in the world");
  }
  return placement;
}

// --- Either ---------------------------------------------------------------------------------------------------------

Lattice lattice_of(const std::string& path, const Placement& placement) {
  Lattice lattice;
  lattice.origin = placement.origin;
  lattice.counts = placement.counts;
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    const Vec3& step = placement.steps[a];
    if (!std::isfinite(step.x + step.y + step.z) || !std::isfinite(lattice.origin[axis]) || lattice.counts[a] < 1) {
      fail_image(path,
                 std::string("its place along ") + "xyz"[axis] + ", expected finite numbers and at least one voxel");
    }
    lattice.spacing[axis] = step[axis];
    const double others = std::abs(step[(axis + 1) % 3]) + std::abs(step[(axis + 2) % 3]);
    if (others != 0.0 || !(step[axis] > 0.0)) throw NotAvailable(path + ": a volume whose axes are turned");
    if (!std::isfinite(lattice.coordinate(axis, lattice.index_max(axis)))) fail_image(path, "its end is not finite");
  }
  return lattice;
}

}  // namespace

bool is_image(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  try {
    InputBuffer input = open_volume(path);
    while (input.pending().size() < kNiftiHead && input.fill()) continue;
    return input.pending().starts_with(kNrrd) || nifti_order(input.pending()).has_value();
  } catch (const InputError&) {
    return false;  // whoever reads it next says why
  }
}

Lattice read_image_lattice(const std::string& path) {
  InputBuffer input = open_volume(path);
  while (input.pending().size() < kNrrd.size() && input.fill()) continue;
  return lattice_of(path, input.pending().starts_with(kNrrd) ? read_nrrd(path) : read_nifti(path));
}

}  // namespace raycone
