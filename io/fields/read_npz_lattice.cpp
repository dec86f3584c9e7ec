#include "io/fields/read_npz_lattice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>

#include "io/files/file_error.h"
#include "io/files/input_buffer.h"
#include "io/files/npy_head.h"
#include "io/files/read_file.h"
#include "io/files/zip_reader.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are read as they are in memory");

constexpr double kMostIndex = 0x1p53;

[[noreturn]] void fail(const std::string& path, const std::string& what) { throw InputError(path + ": " + what); }

const ZipReader::Member& find_array(const ZipReader& archive, const std::string& path, const std::string& name) {
  const ZipReader::Member* const member = archive.find(name + ".npy");
  if (member == nullptr) fail(path, "has no array '" + name + "', expected a lattice that raycone wrote");
  return *member;
}

// An array of `kCount` numbers of type `descriptor`, whatever its shape; in C order.
template <typename Number, std::size_t kCount>
std::array<Number, kCount> read_numbers(const ZipReader& archive, const std::string& path, const std::string& name,
                                        std::string_view descriptor) {
  constexpr std::uint64_t kMostBytes = 1 << 20;  // with the head
  const ZipReader::Member& member = find_array(archive, path, name);
  if (member.size > kMostBytes) fail(archive.name_of(member), "expected " + std::to_string(kCount) + " numbers");
  InputBuffer input(archive.name_of(member), archive.open_checked(member));
  const NpyHead head = read_npy_head(input);
  std::uint64_t count = 1;
  for (const std::uint64_t size : head.shape) count *= std::min<std::uint64_t>(size, kCount + 1);
  if (head.type != descriptor || count != kCount) {
    fail(input.name(), "expected " + std::to_string(kCount) + " numbers of type " + std::string(descriptor));
  }
  std::array<Number, kCount> numbers{};
  require_bytes(input, sizeof numbers, "the array");
  std::memcpy(numbers.data(), input.pending().data(), sizeof numbers);
  input.check_rest();
  if (!head.fortran_order || head.shape.size() != 2) return numbers;
  const std::size_t rows = head.shape[0], columns = head.shape[1];
  std::array<Number, kCount> in_c_order{};
  for (std::size_t n = 0; n < kCount; ++n) in_c_order[n] = numbers[n / columns + n % columns * rows];
  return in_c_order;
}

// Of the first field, which may be packed.
std::array<std::int64_t, 3> read_counts(const ZipReader& archive, const std::string& path) {
  if (archive.find("inside_shape.npy") != nullptr) {
    return read_numbers<std::int64_t, 3>(archive, path, "inside_shape", "<i8");
  }
  static constexpr std::array<std::string_view, 6> kNoFields{"origin.npy",    "spacing.npy",   "index_min.npy",
                                                             "direction.npy", "transform.npy", "raycone.npy"};
  for (const ZipReader::Member& member : archive.members()) {
    if (std::ranges::count(kNoFields, member.name) > 0) continue;
    InputBuffer input(archive.name_of(member), archive.open(member));
    const NpyHead head = read_npy_head(input);
    if (head.shape.size() < 3) continue;
    std::array<std::int64_t, 3> counts{};
    for (std::size_t a = 0; a < 3; ++a) {
      if (static_cast<double>(head.shape[a]) > kMostIndex) fail(input.name(), "has too large a shape");
      counts[a] = static_cast<std::int64_t>(head.shape[a]);
    }
    return counts;
  }
  fail(path, "has no field on a lattice");
}

}  // namespace

bool is_npz(const std::string& path) { return file_starts_with(path, "PK\x03\x04"); }

bool holds_arrays(const std::string& path) {
  try {
    const ZipReader archive(path);
    return std::ranges::any_of(archive.members(), [](const auto& member) { return member.name.ends_with(".npy"); });
  } catch (const InputError&) {
    return false;  // whoever reads it next says why
  }
}

PlacedLattice read_npz_lattice(const std::string& path) {
  const ZipReader archive(path);
  const auto origin = read_numbers<double, 3>(archive, path, "origin", "<f8");
  const auto spacing = read_numbers<double, 3>(archive, path, "spacing", "<f8");
  const auto direction = read_numbers<double, 9>(archive, path, "direction", "<f8");
  const auto index_min = read_numbers<std::int64_t, 3>(archive, path, "index_min", "<i8");
  std::array<Vec3, 3> steps;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(spacing[a] > 0.0) || std::abs(static_cast<double>(index_min[a])) > kMostIndex) {
      fail(path, std::string("has no valid lattice along ") + "ijk"[a] + ", expected a positive spacing and an index");
    }
    steps[a] = spacing[a] * Vec3{direction[a], direction[3 + a], direction[6 + a]};
  }
  const std::array<std::int64_t, 3> counts = read_counts(archive, path);
  if (*std::ranges::min_element(counts) < 1) fail(path, "has a lattice without samples, expected at least one");
  const PlacedLattice lattice({origin[0], origin[1], origin[2]}, steps, index_min, counts);
  if (!lattice.is_finite() || !lattice.spans_space()) {
    fail(path, "has no valid lattice, expected finite places and axes in three directions");
  }
  return lattice;
}

}  // namespace raycone
