// Lists in texts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace raycone {

// "a", "a and b", "a, b and c"; `last`, " and " here, stands before the last word.
[[nodiscard]] inline std::string enumerated(const std::vector<std::string>& words, const std::string& last) {
  std::string text;
  for (std::size_t n = 0; n < words.size(); ++n) {
    if (n > 0) text += n + 1 == words.size() ? last : ", ";
    text += words[n];
  }
  return text;
}

// "a|b|c".
[[nodiscard]] inline std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

// The first `most` of the words, and "7 more" for the others.
[[nodiscard]] inline std::vector<std::string> first_words(std::vector<std::string> words, std::size_t most) {
  if (words.size() <= most) return words;
  const std::size_t more = words.size() - most;
  words.resize(most);
  words.push_back(std::to_string(more) + " more");
  return words;
}

}  // namespace raycone
