// The values of one command's options and operands, and their conversion. They stay strings until here, so that the
// rules of parse_value.h hold for all of them.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "app/process/usage_error.h"
#include "io/files/enumerated.h"

namespace raycone {

class Values {
 public:
  // What was given by the long name of the option, or the operand's name: of an option, the last value counts.
  explicit Values(std::map<std::string, std::vector<std::string>> given) : given_(std::move(given)) {}

  [[nodiscard]] const std::map<std::string, std::vector<std::string>>& all() const { return given_; }
  [[nodiscard]] bool given(const std::string& name) const { return given_.contains(name); }
  [[nodiscard]] std::string text(const std::string& name) const;                // empty if not given
  [[nodiscard]] std::vector<std::string> texts(const std::string& name) const;  // of operands that may be many

  // The same, but `texts` given by `name`; not given if empty.
  [[nodiscard]] Values with(const std::string& name, const std::vector<std::string>& texts) const;

  // Throw UsageError for any other value.
  [[nodiscard]] double positive(const std::string& name, const std::string& unit = "") const;
  [[nodiscard]] std::int64_t integer(const std::string& name, std::int64_t least, std::int64_t most) const;
  // What the word stands for, one of these.
  template <class Meaning>
  [[nodiscard]] Meaning choice(const std::string& name,
                               std::initializer_list<std::pair<const char*, Meaning>> words) const;

  // Throws UsageError if `name` is given together with one of `others`.
  void exclude(const std::string& name, std::initializer_list<const char*> others) const;

 private:
  std::map<std::string, std::vector<std::string>> given_;
};

// A value that an option does not take.
class InvalidValue : public UsageError {
 public:
  InvalidValue(const std::string& name, const std::string& text, const std::string& expected);
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string name_;
  std::string text_;
};

// Throws InvalidValue.
[[noreturn]] void invalid(const std::string& name, const std::string& text, const std::string& expected);

template <class Meaning>
Meaning Values::choice(const std::string& name, std::initializer_list<std::pair<const char*, Meaning>> words) const {
  std::vector<std::string> expected;
  for (const auto& [word, meaning] : words) {
    if (text(name) == word) return meaning;
    expected.emplace_back(word);
  }
  invalid(name, text(name), enumerated(expected, " or "));
}

// Where to read on, to be put behind a message; an empty `command` is raycone itself.
[[nodiscard]] std::string help_hint(const std::string& command);

}  // namespace raycone
