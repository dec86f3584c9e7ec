// Numbers by std::from_chars: exact, and independent of any locale.
#include "app/text/parse_value.h"

#include <charconv>
#include <cmath>

namespace raycone {
namespace {

template <typename Number>
std::optional<Number> whole_text_as(std::string_view text) {
  // from_chars knows no leading plus sign, which people write and other tools print.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

template <typename Number, typename Parse>
std::optional<std::vector<Number>> list_from(std::string_view text, Parse parse) {
  std::vector<Number> numbers;
  for (const std::string_view item : items_of(text)) {
    const std::optional<Number> number = parse(item);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace

std::optional<double> number_from(std::string_view text) {
  const std::optional<double> number = whole_text_as<double>(text);
  if (!number || !std::isfinite(*number)) return std::nullopt;
  return number;
}

std::optional<std::int64_t> integer_from(std::string_view text) { return whole_text_as<std::int64_t>(text); }

std::vector<std::string_view> items_of(std::string_view list) {
  std::vector<std::string_view> items;
  for (std::size_t comma = list.find(','); comma != std::string_view::npos; comma = list.find(',')) {
    items.push_back(list.substr(0, comma));
    list.remove_prefix(comma + 1);
  }
  items.push_back(list);
  return items;
}

std::optional<std::vector<double>> numbers_from(std::string_view text) { return list_from<double>(text, number_from); }

std::optional<std::vector<std::int64_t>> integers_from(std::string_view text) {
  return list_from<std::int64_t>(text, integer_from);
}

std::optional<std::uint64_t> byte_count_from(std::string_view text) {
  constexpr std::string_view kSuffixes = "KMGT";
  double unit = 1.0;
  if (!text.empty()) {
    const char upper =
        text.back() >= 'a' && text.back() <= 'z' ? static_cast<char>(text.back() - 'a' + 'A') : text.back();
    if (const std::size_t power = kSuffixes.find(upper); power != std::string_view::npos) {
      unit = std::ldexp(1.0, 10 * (static_cast<int>(power) + 1));
      text.remove_suffix(1);
    }
  }
  const std::optional<double> number = number_from(text);
  if (!number || !(*number * unit >= 1.0) || !(*number * unit < 0x1p63)) return std::nullopt;
  return static_cast<std::uint64_t>(*number * unit);
}

}  // namespace raycone
