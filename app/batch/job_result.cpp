#include "app/batch/job_result.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include "io/files/file_identity.h"

namespace raycone {

std::string relative_to_mesh(const std::string& path, const std::string& mesh) {
  const std::filesystem::path directory = directory_of(mesh);
  return std::filesystem::path(path).lexically_relative(directory.lexically_normal()).string();
}

// Row and stamp, texts, then lists behind their lengths; warnings are what is left.
Message to_message(const JobResult& result) {
  Message message = to_record(result.row);
  std::ranges::copy(to_fields(result.stamp), std::back_inserter(message));
  message.insert(message.end(), {result.knows_inputs ? "1" : "0", result.grid, result.thumbnail});
  message.push_back(std::to_string(result.buffers.size()));
  for (const StampedFile& file : result.buffers) message.insert(message.end(), {file.path, file.sha256});
  message.push_back(std::to_string(result.written.size()));
  for (const OutputStamp& file : result.written) {
    message.insert(message.end(), {std::to_string(file.size), std::to_string(file.modified)});
  }
  message.insert(message.end(), result.warnings.begin(), result.warnings.end());
  return message;
}

JobResult result_from(const Message& message) {
  MessageStrings strings(message);
  const auto record = strings.take(result_columns().size());
  std::optional<ResultRow> row = row_from({record.begin(), record.end()});
  const std::optional<FileStamp> stamp = stamp_from(strings.take(kStampFields).first<kStampFields>());
  if (!row || !stamp) throw std::runtime_error("not a result");
  JobResult result{.row = std::move(*row), .stamp = *stamp};
  result.knows_inputs = strings.number() != 0;
  result.grid = strings.text();
  result.thumbnail = strings.text();
  for (std::size_t left = strings.count(); left > 0; --left) {
    const auto file = strings.take(2);
    result.buffers.push_back({.path = file[0], .sha256 = file[1]});
  }
  for (std::size_t left = strings.count(); left > 0; --left) {
    const auto size = static_cast<std::uint64_t>(strings.number());
    result.written.push_back({size, strings.number()});
  }
  result.warnings.assign(strings.rest().begin(), strings.rest().end());
  return result;
}

}  // namespace raycone
