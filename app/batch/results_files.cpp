#include "app/batch/results_files.h"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <system_error>
#include <thread>
#include <utility>

#include "app/process/messages.h"
#include "app/process/signals.h"
#include "io/files/counted.h"
#include "io/files/descriptor.h"
#include "io/files/enumerated.h"
#include "io/files/file_error.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

// Held while a results file of `directory` changes: runs of one batch, should there be several, change the same one.
// Where the file system has no locks, runs of different shards still do not get in each other's way. Throws OutputError
// where another process does not let go; sooner where a signal waits that the supervisor holds back.
class DirectoryLock {
 public:
  explicit DirectoryLock(const std::string& directory) : locked_(open_file(directory, O_RDONLY | O_DIRECTORY)) {
    constexpr std::chrono::milliseconds kPause{5};
    constexpr std::chrono::seconds kMost{300}, kMostWithSignal{2};
    const auto begin = std::chrono::steady_clock::now();
    while (locked_ && flock(locked_.number(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EINTR) continue;
      if (errno != EWOULDBLOCK) return;  // there are no locks
      const bool is_interrupted = interruption_waits();
      if (std::chrono::steady_clock::now() - begin >= (is_interrupted ? kMostWithSignal : kMost)) {
        throw OutputError(directory + (is_interrupted ? ": interrupted while waiting for the lock of another process"
                                                      : ": is locked by another process, for 5 minutes now; end it, "
                                                        "or run this again"));
      }
      std::this_thread::sleep_for(kPause);
    }
  }

 private:
  Descriptor locked_;
};

// The names of a shard's files end so: "-3-of-8"; those of the whole batch have nothing there.
std::string suffix_of(const std::optional<Shard>& shard) {
  return shard ? "-" + std::to_string(shard->index) + "-of-" + std::to_string(shard->count) : "";
}

// Of results.csv, and of that of a shard, whose numbers are written as suffix_of() does.
std::smatch match_of_table(const std::string& name) {
  static const std::regex pattern("results(-([1-9][0-9]{0,18})-of-([1-9][0-9]{0,18}))?\\.csv");
  std::smatch match;
  std::regex_match(name, match, pattern);
  return match;
}

// Whose rows those are, of a name that holds_rows().
std::optional<Shard> shard_of(const std::string& name) {
  const std::smatch match = match_of_table(name);
  if (!match[1].matched) return std::nullopt;
  return Shard{std::stoull(match[2]), std::stoull(match[3])};
}

}  // namespace

bool holds_rows(const std::string& name) { return !match_of_table(name).empty(); }

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

// "no results of shards 2, 3 and 5 of 5", of which `present` are there.
std::string missing_line(const std::set<std::uint64_t>& present, std::uint64_t count) {
  constexpr std::size_t kMostNamed = 10;
  const std::uint64_t missing = count - present.size();
  std::vector<std::string> names;
  for (std::uint64_t index = 1; names.size() < std::min<std::uint64_t>(missing, kMostNamed); ++index) {
    if (!present.contains(index)) names.push_back(std::to_string(index));
  }
  if (missing > kMostNamed) names.push_back(std::to_string(missing - kMostNamed) + " more");
  return (missing == 1 ? "no results of shard " : "no results of shards ") + enumerated(names, " and ") + " of " +
         std::to_string(count);
}

}  // namespace

ResultsFiles::ResultsFiles(const std::string& directory, const std::optional<Shard>& shard)
    : directory_(directory),
      rows_(directory + "/results" + suffix_of(shard) + ".csv", CsvLog::Rows::kOfLines, result_columns(),
            {former_result_columns()}),
      origins_(directory + "/batch-state" + suffix_of(shard) + ".csv", CsvLog::Rows::kOfAnyText, origin_columns(),
               former_origin_columns()) {}

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
    count += files.rows_.ends_within_line() ? 1 : 0;
  }
  return count;
}

void warn_of_unreadable_rows(const std::string& directory) {
  const std::size_t rows = count_unreadable_rows(directory);
  if (rows == 0) return;
  print_message("warning: " + directory + ": results: " + counted(rows, "row") +
                " cannot be read, left out; batch makes such meshes again");
}

std::vector<std::string> missing_shards(const std::string& directory) {
  std::map<std::uint64_t, std::set<std::uint64_t>> present;  // by the number of shards
  for (const std::string& name : names_in(directory)) {
    if (!holds_rows(name)) continue;
    const std::optional<Shard> shard = shard_of(name);
    if (!shard) return {};
    if (shard->index <= shard->count) present[shard->count].insert(shard->index);
  }
  std::vector<std::string> lines;
  for (const auto& [count, indices] : present) {
    if (indices.size() < count) lines.push_back(missing_line(indices, count));
  }
  return lines;
}

void remove_from_all_results(const std::string& directory, const std::set<std::string>& meshes) {
  for (const ResultsFiles& files : all_results_files(directory)) files.remove(meshes);
}

bool is_results_file(const std::string& name) {
  const std::string state = "batch-state";
  return holds_rows(name) || (name.starts_with(state) && holds_rows("results" + name.substr(state.size())));
}

}  // namespace raycone
