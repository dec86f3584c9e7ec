#include "app/batch/batch_record.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "app/text/parse_value.h"
#include "io/files/ascii.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

// Columns. A note of a start has no row.
constexpr std::size_t kRow = 1;
constexpr std::size_t kFinished = 2;
constexpr std::size_t kPath = 3;
constexpr std::size_t kStamp = 4;
constexpr std::size_t kBuffers = kStamp + kStampFields;
constexpr std::size_t kWritten = kBuffers + 1;
constexpr std::size_t kVersionColumn = kBuffers + 2;
constexpr std::size_t kOptions = kBuffers + 3;
constexpr std::size_t kMemoryLimit = kBuffers + 4;
constexpr std::size_t kDefaultMemoryLimit = kBuffers + 5;
constexpr std::size_t kTimeout = kBuffers + 6;
constexpr std::size_t kThumbnail = kBuffers + 7;

std::string hash_of_line(const std::string& line) {
  constexpr std::size_t kDigits = 16;
  return sha256(line).substr(0, kDigits);
}

std::optional<FileStamp> stamp_in(const CsvRecord& record, std::size_t at) {
  return stamp_from(std::span<const std::string, kStampFields>(record.data() + at, kStampFields));
}

// A CSV line a file, as one field.
std::string to_text(const std::vector<StampedFile>& files) {
  std::string text;
  for (const StampedFile& file : files) {
    CsvRecord record{file.path, file.sha256};
    std::ranges::copy(to_fields(file.stamp), std::back_inserter(record));
    text += csv_line(record);
  }
  return text;
}

std::optional<std::vector<StampedFile>> files_from(const std::string& text) {
  std::vector<StampedFile> files;
  for (const CsvRecord& record : parse_csv(text).records) {
    if (record.size() != 2 + kStampFields) return std::nullopt;
    const std::optional<FileStamp> stamp = stamp_in(record, 2);
    if (!stamp) return std::nullopt;
    files.push_back({record[0], *stamp, record[1]});
  }
  return files;
}

std::string to_text(const std::vector<OutputStamp>& outputs) {
  std::string text;
  for (const OutputStamp& output : outputs) {
    text += csv_line({std::to_string(output.size), std::to_string(output.modified)});
  }
  return text;
}

std::optional<std::vector<OutputStamp>> outputs_from(const std::string& text) {
  std::vector<OutputStamp> outputs;
  for (const CsvRecord& record : parse_csv(text).records) {
    if (record.size() != 2) return std::nullopt;
    const std::optional<std::int64_t> size = integer_from(record[0]);
    const std::optional<std::int64_t> modified = integer_from(record[1]);
    if (!size || !modified) return std::nullopt;
    outputs.push_back({static_cast<std::uint64_t>(*size), *modified});
  }
  return outputs;
}

}  // namespace

std::int64_t finished(const BatchRecord& record) {
  return record.origin ? record.origin->finished : record.finished_by;
}

void keep_latest(BatchRecord record, BatchRecords& records) {
  const std::string mesh = record.row.mesh;
  const auto known = records.find(mesh);
  if (known == records.end() || finished(known->second) <= finished(record)) {
    records.insert_or_assign(mesh, std::move(record));
  }
}

const CsvRecord& origin_columns() {
  static const CsvRecord columns{"mesh",        "row",        "finished_ns", "path",         "size",
                                 "modified_ns", "changed_ns", "inode",       "recent",       "buffers",
                                 "written",     "version",    "options",     "memory_limit", "default_memory_limit",
                                 "timeout_s",   "thumbnail"};
  return columns;
}

std::vector<CsvRecord> former_origin_columns() {
  const CsvRecord last{"mesh",        "row",          "size",
                       "modified_ns", "companions",   "version",
                       "options",     "memory_limit", "default_memory_limit",
                       "timeout_s",   "finished_ns",  "thumbnail",
                       "changed_ns",  "path"};
  return {{last.begin(), last.end() - 2}, {last.begin(), last.end() - 1}, last};
}

CsvRecord to_record(const RowOrigin& origin, const std::string& mesh, const std::string& line) {
  CsvRecord record(origin_columns().size());
  record.front() = mesh;
  record[kRow] = hash_of_line(line);
  record[kFinished] = std::to_string(origin.finished);
  record[kPath] = origin.path;
  std::ranges::copy(to_fields(origin.stamp), record.begin() + kStamp);
  record[kBuffers] = to_text(origin.buffers);
  record[kWritten] = to_text(origin.written);
  record[kVersionColumn] = origin.version;
  record[kOptions] = origin.options;
  record[kMemoryLimit] = std::to_string(origin.memory_limit);
  record[kDefaultMemoryLimit] = origin.default_memory_limit ? "1" : "0";
  record[kTimeout] = shortest_text(origin.timeout);
  record[kThumbnail] = origin.thumbnail;
  return record;
}

CsvRecord to_start_record(const std::string& mesh, std::int64_t time) {
  CsvRecord record(origin_columns().size());
  record.front() = mesh;
  record[kFinished] = std::to_string(time);
  return record;
}

std::optional<std::int64_t> start_from(const CsvRecord& record) {
  if (record.size() != origin_columns().size() || !record[kRow].empty()) return std::nullopt;
  return integer_from(record[kFinished]);
}

bool is_about(const CsvRecord& record, const std::string& line) {
  return record.size() == origin_columns().size() && record[kRow] == hash_of_line(line);
}

std::optional<RowOrigin> origin_from(const CsvRecord& record) {
  if (record.size() != origin_columns().size()) return std::nullopt;
  const std::optional<FileStamp> stamp = stamp_in(record, kStamp);
  std::optional<std::vector<StampedFile>> buffers = files_from(record[kBuffers]);
  std::optional<std::vector<OutputStamp>> written = outputs_from(record[kWritten]);
  const std::optional<std::int64_t> memory_limit = integer_from(record[kMemoryLimit]);
  const std::optional<double> timeout = number_from(record[kTimeout]);
  const std::optional<std::int64_t> finished = integer_from(record[kFinished]);
  if (!stamp || !buffers || !written || !memory_limit || !timeout || !finished) return std::nullopt;
  return RowOrigin{.stamp = *stamp,
                   .buffers = std::move(*buffers),
                   .written = std::move(*written),
                   .version = record[kVersionColumn],
                   .options = record[kOptions],
                   .memory_limit = static_cast<std::uint64_t>(*memory_limit),
                   .default_memory_limit = record[kDefaultMemoryLimit] == "1",
                   .timeout = *timeout,
                   .finished = *finished,
                   .thumbnail = record[kThumbnail],
                   .path = record[kPath]};
}

}  // namespace raycone
