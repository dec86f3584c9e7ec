#include "app/batch/batch_record.h"

#include <utility>

#include "app/text/parse_value.h"
#include "io/files/ascii.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

constexpr std::size_t kRow = 1;  // empty in a note of a start
constexpr std::size_t kFinished = 10;
constexpr std::size_t kChanged = 12;
constexpr std::size_t kPath = 13;

std::string hash_of_line(const std::string& line) {
  constexpr std::size_t kDigits = 16;
  return sha256(line).substr(0, kDigits);
}

// Empty where the time does not vouch for what was read.
std::string changed_text(const FileStamp& stamp) { return stamp.recent ? "" : std::to_string(stamp.changed); }

// A CSV line a file, as one field.
std::string to_text(const std::vector<StampedFile>& files) {
  std::string text;
  for (const StampedFile& file : files) {
    const FileStamp& stamp = file.stamp;
    text += csv_line(
        {file.path, std::to_string(stamp.size), std::to_string(stamp.modified), changed_text(stamp), file.sha256});
  }
  return text;
}

std::optional<FileStamp> stamp_from(const std::string& size, const std::string& modified, const std::string& changed) {
  const std::optional<std::int64_t> bytes = integer_from(size);
  const std::optional<std::int64_t> time = integer_from(modified);
  if (!bytes || !time) return std::nullopt;
  const std::optional<std::int64_t> change = integer_from(changed);
  return FileStamp{static_cast<std::uint64_t>(*bytes), *time, change.value_or(0), !change};
}

std::optional<std::vector<StampedFile>> files_from(const std::string& text) {
  constexpr std::size_t kFields = 5;
  std::vector<StampedFile> files;
  for (const CsvRecord& record : parse_csv(text).records) {
    if (record.size() != kFields) return std::nullopt;
    const std::optional<FileStamp> stamp = stamp_from(record[1], record[2], record[3]);
    if (!stamp) return std::nullopt;
    files.push_back({record[0], *stamp, record[4]});
  }
  return files;
}

}  // namespace

std::int64_t finished(const BatchRecord& record) { return record.origin ? record.origin->finished : 0; }

void keep_latest(BatchRecord record, BatchRecords& records) {
  const std::string mesh = record.row.mesh;
  const auto known = records.find(mesh);
  if (known == records.end() || finished(known->second) <= finished(record)) {
    records.insert_or_assign(mesh, std::move(record));
  }
}

const CsvRecord& origin_columns() {
  static const CsvRecord columns{"mesh",        "row",          "size",
                                 "modified_ns", "companions",   "version",
                                 "options",     "memory_limit", "default_memory_limit",
                                 "timeout_s",   "finished_ns",  "thumbnail",
                                 "changed_ns",  "path"};
  return columns;
}

std::vector<CsvRecord> former_origin_columns() {
  const auto first = origin_columns().begin();
  return {{first, first + kChanged}, {first, first + kPath}};
}

CsvRecord to_record(const RowOrigin& origin, const std::string& mesh, const std::string& line) {
  return {mesh,
          hash_of_line(line),
          std::to_string(origin.stamp.size),
          std::to_string(origin.stamp.modified),
          to_text(origin.companions),
          origin.version,
          origin.options,
          std::to_string(origin.memory_limit),
          origin.default_memory_limit ? "1" : "0",
          shortest_text(origin.timeout),
          std::to_string(origin.finished),
          origin.thumbnail,
          changed_text(origin.stamp),
          origin.path};
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
  const std::optional<FileStamp> stamp = stamp_from(record[2], record[3], record[kChanged]);
  std::optional<std::vector<StampedFile>> companions = files_from(record[4]);
  const std::optional<std::int64_t> memory_limit = integer_from(record[7]);
  const std::optional<double> timeout = number_from(record[9]);
  const std::optional<std::int64_t> finished = integer_from(record[kFinished]);
  if (!stamp || !companions || !memory_limit || !timeout || !finished) return std::nullopt;
  return RowOrigin{*stamp,
                   std::move(*companions),
                   record[5],
                   record[6],
                   static_cast<std::uint64_t>(*memory_limit),
                   record[8] == "1",
                   *timeout,
                   *finished,
                   false,
                   record[11],
                   record[kPath]};
}

}  // namespace raycone
