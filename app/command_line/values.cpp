#include "app/command_line/values.h"

#include <optional>

#include "app/text/parse_value.h"

namespace raycone {

std::string Values::text(const std::string& name) const {
  const std::vector<std::string> all = texts(name);
  return all.empty() ? std::string() : all.back();
}

std::vector<std::string> Values::texts(const std::string& name) const {
  const auto found = given_.find(name);
  return found == given_.end() ? std::vector<std::string>() : found->second;
}

Values Values::with(const std::string& name, const std::vector<std::string>& texts) const {
  Values result = *this;
  result.given_.erase(name);
  if (!texts.empty()) result.given_[name] = texts;
  return result;
}

double Values::positive(const std::string& name, const std::string& unit) const {
  const std::optional<double> number = number_from(text(name));
  const std::string of_unit = unit.empty() ? "" : " of " + unit;
  if (!number || !(*number > 0.0)) invalid(name, text(name), "a positive number" + of_unit);
  return *number;
}

std::int64_t Values::integer(const std::string& name, std::int64_t least, std::int64_t most) const {
  const std::optional<std::int64_t> number = integer_from(text(name));
  if (number && *number >= least && *number <= most) return *number;
  invalid(name, text(name), "an integer from " + std::to_string(least) + " to " + std::to_string(most));
}

void Values::exclude(const std::string& name, std::initializer_list<const char*> others) const {
  if (!given(name)) return;
  for (const char* const other : others) {
    if (given(other)) throw UsageError(name + ": cannot be combined with " + other);
  }
}

InvalidValue::InvalidValue(const std::string& name, const std::string& text, const std::string& expected)
    : UsageError(name + " " + text + ": expected " + expected), name_(name), text_(text) {}

void invalid(const std::string& name, const std::string& text, const std::string& expected) {
  throw InvalidValue(name, text, expected);
}

std::string help_hint(const std::string& command) {
  return "; see 'raycone " + (command.empty() ? "" : command + " ") + "--help'";
}

}  // namespace raycone
