#include "app/command_line/suggestion.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>

#include "app/command_line/value_candidates.h"
#include "app/text/parse_value.h"
#include "io/files/ascii.h"

namespace raycone {
namespace {

// What nobody types can be no misspelling; the distance takes the product of the lengths.
constexpr std::size_t kLongestWord = 64;

// The least number of letters to be changed, added, removed or swapped with their neighbours that makes `a` of `b`
// (the restricted distance of Damerau, 1964, and Levenshtein, 1966).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last.back();
}

std::string without_dashes(const std::string& word) {
  return word.substr(std::min(word.find_first_not_of('-'), word.size()));
}

// "abs=" of "abs=0.5": what a value with a number is told by.
std::string up_to_equals(std::string_view value) {
  const std::size_t equals = value.find('=');
  return std::string(value.substr(0, equals == std::string_view::npos ? equals : equals + 1));
}

// The one of `words` that `misspelt` is most like, the first of several.
std::optional<std::string> nearest_word(const std::string& misspelt, const std::vector<std::string>& words) {
  constexpr std::size_t kShortest = 3;
  const std::string given = lower_case(without_dashes(misspelt));
  if (given.size() < kShortest || given.size() > kLongestWord) return std::nullopt;
  const std::size_t most = std::max<std::size_t>(given.size() / 4, 1);
  std::optional<std::string> nearest;
  std::size_t least = most + 1;
  for (const std::string& word : words) {
    const std::string known = lower_case(without_dashes(word));
    const std::size_t distance = known.starts_with(given) ? 1 : edit_distance(given, known);
    if (distance >= least) continue;
    least = distance;
    nearest = word;
  }
  return nearest;
}

}  // namespace

std::string suggestion(const std::string& misspelt, const std::vector<std::string>& words) {
  const std::optional<std::string> word = nearest_word(misspelt, words);
  return word ? "; did you mean " + *word + "?" : "";
}

std::string value_suggestion(const std::string& value, const std::string& placeholder) {
  const std::vector<std::string> words = candidates_for(placeholder).words;
  for (const std::string_view item : items_of(value)) {
    const std::string word = up_to_equals(item);
    if (std::ranges::count(words, word) == 0) return suggestion(word, words);
  }
  return "";
}

}  // namespace raycone
