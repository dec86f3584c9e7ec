#include "io/fields/nrrd_head.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "io/fields/volume_error.h"
#include "io/files/ascii.h"
#include "io/files/text_scanner.h"

namespace raycone {
namespace {

std::string without_escapes(std::string_view text) {
  std::string result;
  for (std::size_t n = 0; n < text.size(); ++n) {
    const char next = text[n] == '\\' && n + 1 < text.size() ? text[n + 1] : '\0';
    if (next == 'n' || next == '\\') ++n;
    result += next == 'n' ? '\n' : text[n];
  }
  return result;
}

// --- Fields ---------------------------------------------------------------------------------------------------------

// What a field holds, one number, vector or word after the other; blanks and commas may stand between.
class Numbers {
 public:
  Numbers(const std::string& path, const NrrdHead& head, const std::string& key) : path_(path), key_(key) {
    const auto found = head.fields.find(key);
    if (found == head.fields.end()) fail_as_volume(path, "it has no " + key);
    rest_ = text_ = found->second;
  }

  // Whether the next one is this word, which is then behind.
  bool take(std::string_view word) {
    skip();
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }

  // The next one where that is a finite number.
  std::optional<double> take_number() {
    skip();
    double number = 0.0;
    const char* const after = parse_number(rest_.data(), rest_.data() + rest_.size(), number);
    if (!after || !std::isfinite(number)) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(after - rest_.data()));
    return number;
  }

  double next(const std::string& expected) {
    const std::optional<double> number = take_number();
    if (!number) fail(expected);
    return *number;
  }

  Vec3 next_vector(const std::string& expected) {
    if (!take("(")) fail(expected);
    Vec3 v;
    for (int axis = 0; axis < 3; ++axis) v[axis] = next(expected);
    if (!take(")")) fail(expected);
    return v;
  }

  void end(const std::string& expected) {
    skip();
    if (!rest_.empty()) fail(expected);
  }

  [[noreturn]] void fail(const std::string& expected) const {
    fail_as_volume(path_, key_ + ", expected " + expected + ", found '" + excerpt(text_) + '\'');
  }

 private:
  void skip() { rest_.remove_prefix(std::min(rest_.find_first_not_of(", \t"), rest_.size())); }

  const std::string& path_;
  std::string key_;
  std::string_view text_, rest_;
};

std::size_t read_dimension(const std::string& path, const NrrdHead& head) {
  constexpr double kMost = 16;  // the format's
  const std::string expected = "a number from 3 to 16";
  Numbers numbers(path, head, "dimension");
  const double dimension = numbers.next(expected);
  numbers.end(expected);
  if (!(dimension >= 3.0 && dimension <= kMost) || dimension != std::floor(dimension)) numbers.fail(expected);
  return static_cast<std::size_t>(dimension);
}

bool is_size(double number) { return number >= 1.0 && number <= 0x1p53 && number == std::floor(number); }

std::vector<std::int64_t> read_sizes(const std::string& path, const NrrdHead& head, std::size_t dimension) {
  const std::string expected = std::to_string(dimension) + " whole numbers of at least 1";
  Numbers numbers(path, head, "sizes");
  std::vector<std::int64_t> sizes;
  for (std::size_t n = 0; n < dimension; ++n) {
    const double size = numbers.next(expected);
    if (!is_size(size)) numbers.fail(expected);
    sizes.push_back(static_cast<std::int64_t>(size));
  }
  numbers.end(expected);
  return sizes;
}

// --- Where the samples lie ------------------------------------------------------------------------------------------

// What to multiply coordinates by, to make them right, anterior, superior.
Vec3 signs_of_space(const std::string& path, const NrrdHead& head) {
  const auto space = head.fields.find("space");
  if (space == head.fields.end()) return {1, 1, 1};  // "space dimension: 3", and no names for its axes
  const std::string name = lower_case(space->second);
  if (name == "right-anterior-superior" || name == "ras") return {1, 1, 1};
  if (name == "left-anterior-superior" || name == "las") return {-1, 1, 1};
  if (name == "left-posterior-superior" || name == "lps") return {-1, -1, 1};
  static constexpr std::array kOfNoBody{"scanner-xyz", "3d-right-handed", "3drh", "3d-left-handed", "3dlh"};
  if (std::ranges::find(kOfNoBody, name) != kOfNoBody.end()) return {1, 1, 1};
  fail_as_volume(path, "its space, expected right-anterior-superior or another of three axes, found '" +
                           excerpt(space->second) + '\'');
}

Vec3 times(const Vec3& a, const Vec3& b) { return Vec3{a.x * b.x, a.y * b.y, a.z * b.z} + Vec3{}; }  // no -0

// The three of the world.
class Axes {
 public:
  std::array<Vec3, 3> steps;
  std::array<std::int64_t, 3> counts{};

  [[nodiscard]] std::size_t size() const { return size_; }
  void add(const Vec3& step, std::int64_t count, const Numbers& numbers) {
    if (size_ == 3) numbers.fail("3 axes of the world");
    steps[size_] = step;
    counts[size_++] = count;
  }
  void check(const Numbers& numbers) const {
    if (size_ != 3) numbers.fail("3 axes of the world");
  }

 private:
  std::size_t size_ = 0;
};

// Whether the place of the samples is told in the world's coordinates, by whatever of the fields for that.
bool has_space(const NrrdHead& head) {
  static constexpr std::array kKeys{"space",     "space dimension", "space directions", "space origin",
                                    "axis mins", "axismins",        "axis maxs",        "axismaxs"};
  return std::ranges::any_of(kKeys, [&](const char* key) { return head.fields.contains(key); });
}

// Those of the world: all that are not "none".
Axes directed_axes(const std::string& path, const NrrdHead& head, const std::vector<std::int64_t>& sizes) {
  const std::string expected = std::to_string(sizes.size()) + " vectors of 3 numbers, or none for other axes";
  Numbers numbers(path, head, "space directions");
  Axes axes;
  for (const std::int64_t size : sizes) {
    if (numbers.take("none")) continue;
    axes.add(numbers.next_vector(expected), size, numbers);
  }
  numbers.end(expected);
  axes.check(numbers);
  return axes;
}

// A head without directions: the steps are along the axes.
Axes spaced_axes(const std::string& path, const NrrdHead& head, const std::vector<std::int64_t>& sizes) {
  const std::string expected = std::to_string(sizes.size()) + " numbers";
  Numbers numbers(path, head, "spacings");
  Axes axes;
  for (const std::int64_t size : sizes) {
    if (numbers.take("nan") || numbers.take("NaN")) continue;
    Vec3 step;
    step[static_cast<int>(axes.size())] = numbers.next(expected);
    axes.add(step, size, numbers);
  }
  numbers.end(expected);
  axes.check(numbers);
  return axes;
}

// --- Lines ----------------------------------------------------------------------------------------------------------

// Up to the empty line that ends a head, or the end of the file. Labels of many names take megabytes.
std::string_view read_head(InputBuffer& input) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 26;
  constexpr std::size_t kLongestEnd = 3;  // may begin in what has been searched
  std::size_t searched = 0, end = std::string_view::npos;
  do {
    const std::string_view pending = input.pending();
    const std::size_t from = searched - std::min(searched, kLongestEnd - 1);
    end = std::min(pending.find("\n\n", from), pending.find("\n\r\n", from));
    searched = pending.size();
  } while (end == std::string_view::npos && searched < kMostBytes && input.fill());
  const std::string_view text = input.pending().substr(0, end);
  if (text.size() >= kMostBytes) fail_as_volume(input.name(), "its head, expected an empty line within 64 MB");
  return text;
}

}  // namespace

NrrdHead read_nrrd_head(InputBuffer& input) {
  std::string_view text = read_head(input);
  NrrdHead head;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    while (!line.empty() && std::string_view("\r \t").find(line.back()) != std::string_view::npos) {
      line.remove_suffix(1);
    }
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || line.starts_with('#')) continue;
    const std::string_view key = line.substr(0, colon), rest = line.substr(colon + 1);
    if (rest.starts_with('=')) {
      head.pairs.emplace(without_escapes(key), without_escapes(rest.substr(1)));
    } else if (rest.starts_with(' ')) {
      if (!head.fields.emplace(lower_case(key), rest.substr(1)).second) {
        fail_as_volume(input.name(), "its head has two fields \"" + excerpt(lower_case(key)) + '"');
      }
    }
  }
  return head;
}

std::vector<std::uint64_t> nrrd_shape(const NrrdHead& head) {
  std::vector<std::uint64_t> shape;
  if (!head.fields.contains("sizes")) return shape;
  const std::string no_path;
  Numbers numbers(no_path, head, "sizes");
  for (auto size = numbers.take_number(); size && is_size(*size); size = numbers.take_number()) {
    shape.push_back(static_cast<std::uint64_t>(*size));
  }
  return shape;
}

PlacedLattice nrrd_lattice(const std::string& path, const NrrdHead& head) {
  const std::vector<std::int64_t> sizes = read_sizes(path, head, read_dimension(path, head));
  if (!has_space(head)) {
    const Axes axes = spaced_axes(path, head, sizes);
    return {Vec3{}, axes.steps, {0, 0, 0}, axes.counts};
  }
  Axes axes = directed_axes(path, head, sizes);
  const Vec3 signs = signs_of_space(path, head);
  for (Vec3& step : axes.steps) step = times(signs, step);
  const std::string expected = "3 numbers in parentheses";
  Numbers numbers(path, head, "space origin");
  const Vec3 origin = numbers.next_vector(expected);
  numbers.end(expected);
  return {times(signs, origin), axes.steps, {0, 0, 0}, axes.counts};
}

}  // namespace raycone
