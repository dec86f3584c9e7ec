#include "app/batch/job_result.h"

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>

#include "app/text/parse_value.h"

namespace raycone {
namespace {

std::int64_t integer_in(const std::string& text) {
  if (const std::optional<std::int64_t> number = integer_from(text)) return *number;
  throw std::runtime_error("a message has no number where one is expected");
}

}  // namespace

// The row, the thumbnail, the number of companions and two strings for each.
Message to_message(const JobResult& result) {
  Message message = to_record(result.row);
  message.push_back(result.thumbnail);
  message.push_back(std::to_string(result.companions.size()));
  for (const StampedFile& file : result.companions) {
    message.insert(message.end(), {file.path, file.sha256});
  }
  message.insert(message.end(), result.warnings.begin(), result.warnings.end());
  return message;
}

JobResult result_from(const Message& message) {
  const std::size_t columns = result_columns().size();
  if (message.size() < columns + 2) throw std::runtime_error("not a result");
  const auto row_end = message.begin() + static_cast<std::ptrdiff_t>(columns);
  std::optional<ResultRow> row = row_from({message.begin(), row_end});
  if (!row) throw std::runtime_error("not a result");
  JobResult result{std::move(*row), {}, message[columns], {}};
  const auto companions = static_cast<std::size_t>(integer_in(message[columns + 1]));
  std::size_t at = columns + 2;
  if ((message.size() - at) / 2 < companions) throw std::runtime_error("not a result");
  for (std::size_t i = 0; i < companions; ++i, at += 2) {
    result.companions.push_back({.path = message[at], .sha256 = message[at + 1]});
  }
  result.warnings.assign(message.begin() + static_cast<std::ptrdiff_t>(at), message.end());
  return result;
}

}  // namespace raycone
