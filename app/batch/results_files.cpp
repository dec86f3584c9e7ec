#include "app/batch/results_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <system_error>
#include <utility>

#include "app/batch/file_stamp.h"
#include "io/files/file_error.h"
#include "io/files/output_file.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

// Held while a results file of `directory` changes: runs of one batch, should there be several, change the same one.
// Where the file system has no locks, runs of different shards still do not get in each other's way.
class DirectoryLock {
 public:
  explicit DirectoryLock(const std::string& directory)
      : descriptor_(open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    while (descriptor_ >= 0 && flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) {
    }
  }
  ~DirectoryLock() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int descriptor_;
};

[[noreturn]] void fail_writing(const std::string& path, int error) {
  throw OutputError(path + ": cannot write: " + std::generic_category().message(error));
}

// The names of a shard's files end so: "-3-of-8"; those of the whole batch have nothing there.
std::string suffix_of(const std::optional<Shard>& shard) {
  return shard ? "-" + std::to_string(shard->index) + "-of-" + std::to_string(shard->count) : "";
}

// Whose rows those are.
std::optional<Shard> shard_of(const std::string& name) {
  static const std::regex pattern("results-([0-9]+)-of-([0-9]+)\\.csv");
  std::smatch match;
  if (!std::regex_match(name, match, pattern)) return std::nullopt;
  return Shard{std::stoull(match[1]), std::stoull(match[2])};
}

}  // namespace

bool holds_rows(const std::string& name) {
  static const std::regex pattern("results(-[0-9]{1,19}-of-[0-9]{1,19})?\\.csv");
  return std::regex_match(name, pattern);
}

std::vector<std::string> names_in(const std::string& directory) {
  std::vector<std::string> names;
  std::error_code error;
  fs::directory_iterator entry(directory, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  const bool is_none = error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory;
  if (error && !is_none) fail_to_read(directory, error.value());
  return names;
}

namespace {

std::vector<ResultsFiles> all_results_files(const std::string& directory) {
  std::vector<ResultsFiles> all;
  for (const std::string& name : names_in(directory)) {
    if (holds_rows(name)) all.emplace_back(directory, shard_of(name));
  }
  return all;
}

// Of several starts of a mesh the latest counts.
void note_start(const std::string& mesh, std::int64_t time, Starts& starts) {
  std::int64_t& latest = starts[mesh];
  latest = std::max(latest, time);
}

BatchRecord record_of(ResultRow row, std::int64_t written_by, const std::map<std::string, CsvRecord>& origins) {
  const auto origin = origins.find(row.mesh);
  BatchRecord record{std::move(row), std::nullopt, written_by};
  if (origin != origins.end() && is_about(origin->second, csv_line(to_record(record.row)))) {
    record.origin = origin_from(origin->second);
  }
  return record;
}

}  // namespace

std::string CsvLog::text() const {
  std::error_code error;
  const fs::file_status status = fs::status(path_, error);
  if (status.type() == fs::file_type::not_found) return "";
  // A pipe would keep us waiting.
  if (fs::is_other(status)) throw InputError(path_ + ": is a pipe or device, expected a file");
  return read_file(path_);
}

std::vector<CsvRecord> CsvLog::read() const {
  const std::string all = text();
  const std::string header = csv_line(columns_);
  for (const CsvRecord& columns : former_columns_) {
    const std::string former = csv_line(columns);
    if (all.starts_with(former)) return parse_csv(std::string_view(all).substr(former.size())).records;
  }
  if (header.starts_with(all)) return {};  // empty, or a header that was never completed
  if (!all.starts_with(header)) {
    const std::string expected = header.substr(0, header.find_last_not_of("\r\n") + 1);
    throw InputError(path_ + ":1: not written by raycone batch, expected " + expected);
  }
  return parse_csv(std::string_view(all).substr(header.size())).records;
}

// Where the last write(2) was cut short, because its process was killed, its line is cut off. That needs a look at the
// whole file, as fields may hold line feeds, but only where others have written to it.
off_t CsvLog::drop_incomplete_line(int descriptor) const {
  const off_t size = lseek(descriptor, 0, SEEK_END);
  if (size == complete_) return size;
  const auto complete = static_cast<off_t>(parse_csv(read_file(path_)).complete);
  if (ftruncate(descriptor, complete) != 0) fail_writing(path_, errno);
  return complete;
}

std::int64_t CsvLog::modified() const { return stamp_of(path_).modified; }

void CsvLog::append(const std::string& line) const {
  constexpr mode_t kMode = 0666;  // less the umask
  const int descriptor = open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, kMode);
  if (descriptor < 0) fail_writing(path_, errno);
  const off_t size = drop_incomplete_line(descriptor);
  const std::string text = (size == 0 ? csv_line(columns_) : "") + line;
  const ssize_t written = write(descriptor, text.data(), text.size());
  int error = written < 0 ? errno : ENOSPC;
  const bool complete = written == static_cast<ssize_t>(text.size());
  if (!complete && written > 0 && ftruncate(descriptor, size) != 0) error = errno;
  if (close(descriptor) != 0 && complete && errno != EINTR) fail_writing(path_, errno);
  if (!complete) fail_writing(path_, error);
  complete_ = size + written;
}

void CsvLog::replace(const std::vector<std::string>& lines) const {
  std::string wanted = csv_line(columns_);
  for (const std::string& line : lines) wanted += line;
  if (text() == wanted) return sync();
  OutputFile file(path_);
  file.write(wanted.data(), wanted.size());
  file.commit();
}

void CsvLog::sync() const {
  const int descriptor = open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;  // there is none
  const int result = fsync(descriptor);
  const int error = errno;
  close(descriptor);
  if (result != 0 && error != EINVAL && error != ENOSYS && error != EINTR) fail_writing(path_, error);
}

ResultsFiles::ResultsFiles(const std::string& directory, const std::optional<Shard>& shard)
    : directory_(directory),
      rows_(directory + "/results" + suffix_of(shard) + ".csv", result_columns(), {former_result_columns()}),
      origins_(directory + "/batch-state" + suffix_of(shard) + ".csv", origin_columns(), former_origin_columns()) {}

BatchRecords ResultsFiles::read() const { return contents().records; }

ResultsFiles::Contents ResultsFiles::contents() const {
  Contents contents;
  std::map<std::string, CsvRecord> origins;  // of each mesh the last one
  for (CsvRecord& record : origins_.read()) {
    const std::string mesh = record.front();
    if (const std::optional<std::int64_t> start = start_from(record)) {
      note_start(mesh, *start, contents.starts);
    } else {
      origins.insert_or_assign(mesh, std::move(record));
    }
  }
  const std::int64_t written_by = rows_.modified();
  for (const CsvRecord& record : rows_.read()) {
    std::optional<ResultRow> row = row_from(record);
    if (!row || row->mesh.empty()) continue;  // as versions before 1.0.0 wrote them of directories that are missing
    const std::string mesh = row->mesh;
    contents.records.insert_or_assign(mesh, record_of(std::move(*row), written_by, origins));
  }
  for (const auto& [mesh, record] : origins) {
    const auto row = contents.records.find(mesh);
    if (row != contents.records.end() && row->second.origin) continue;
    // Its row was never written, or has been lost: what that was about lies there.
    if (const std::optional<RowOrigin> origin = origin_from(record))
      note_start(mesh, origin->finished, contents.starts);
  }
  return contents;
}

void ResultsFiles::forget(const Starts& meshes) const {
  const DirectoryLock lock(directory_);
  Contents all = contents();
  std::erase_if(all.records, [&meshes](const auto& record) { return meshes.contains(record.first); });
  for (const auto& [mesh, start] : meshes) all.starts.insert_or_assign(mesh, start);
  write(all);
}

void ResultsFiles::remove(const std::set<std::string>& meshes) const {
  const DirectoryLock lock(directory_);
  Contents all = contents();
  const auto removed =
      std::erase_if(all.records, [&meshes](const auto& record) { return meshes.contains(record.first); });
  if (removed > 0) write(all);
}

// The origin first: without it a row would have to be made again.
void ResultsFiles::append(const BatchRecord& record) const {
  const DirectoryLock lock(directory_);
  const std::string line = csv_line(to_record(record.row));
  if (record.origin) origins_.append(csv_line(to_record(*record.origin, record.row.mesh, line)));
  rows_.append(line);
}

void ResultsFiles::merge(const BatchRecords& records) const {
  const DirectoryLock lock(directory_);
  Contents all = contents();
  for (const auto& [mesh, record] : records) {
    const auto known = all.records.find(mesh);
    if (known != all.records.end() && !known->second.origin) all.records.erase(known);
    keep_latest(record, all.records);
  }
  write(all);
}

void ResultsFiles::write(const Contents& contents) const {
  std::vector<std::string> rows;
  std::vector<std::string> origins;
  for (const auto& [mesh, record] : contents.records) {
    rows.push_back(csv_line(to_record(record.row)));
    if (record.origin) origins.push_back(csv_line(to_record(*record.origin, mesh, rows.back())));
  }
  for (const auto& [mesh, start] : contents.starts) {
    const auto record = contents.records.find(mesh);
    const bool over = record != contents.records.end() && finished(record->second) > start;
    if (!over) origins.push_back(csv_line(to_start_record(mesh, start)));
  }
  origins_.replace(origins);
  rows_.replace(rows);
}

BatchRecords read_all_results(const std::string& directory) {
  BatchRecords all;
  Starts starts;
  for (const ResultsFiles& files : all_results_files(directory)) {
    ResultsFiles::Contents contents = files.contents();
    for (auto& [mesh, record] : contents.records) keep_latest(std::move(record), all);
    for (const auto& [mesh, start] : contents.starts) note_start(mesh, start, starts);
  }
  for (auto& [mesh, record] : all) {
    const auto start = starts.find(mesh);
    if (!record.origin || start == starts.end() || finished(record) > start->second) continue;
    record.origin->superseded = true;
    record.origin->finished = start->second;
  }
  return all;
}

std::size_t count_unreadable_rows(const std::string& directory) {
  std::size_t count = 0;
  for (const ResultsFiles& files : all_results_files(directory)) {
    const std::vector<CsvRecord> rows = files.rows_.read();
    count += static_cast<std::size_t>(std::ranges::count_if(rows, [](const CsvRecord& row) { return !row_from(row); }));
  }
  return count;
}

void remove_from_all_results(const std::string& directory, const std::set<std::string>& meshes) {
  for (const ResultsFiles& files : all_results_files(directory)) files.remove(meshes);
}

bool is_results_file(const std::string& name) {
  const std::string state = "batch-state";
  return holds_rows(name) || (name.starts_with(state) && holds_rows("results" + name.substr(state.size())));
}

}  // namespace raycone
