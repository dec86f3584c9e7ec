#include "app/batch/csv_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "app/batch/file_stamp.h"
#include "app/process/memory_limit.h"
#include "io/files/file_error.h"
#include "io/files/output_file.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_writing(const std::string& path, int error) {
  throw OutputError(path + ": cannot write: " + std::generic_category().message(error));
}

}  // namespace

std::string CsvLog::text(std::uint64_t most_bytes) const {
  std::error_code error;
  const fs::file_status status = fs::status(path_, error);
  if (status.type() == fs::file_type::not_found) return "";
  // A pipe would keep us waiting.
  if (fs::is_other(status)) throw InputError(path_ + ": is a pipe or device, expected a file");
  return read_file(path_, most_bytes);
}

// What is behind the last complete line must be what a killed writer left of one. Where rows are in it, that line is
// damaged: nobody shall take them for a part of it.
void CsvLog::check_rest(std::string_view rest, std::size_t line) const {
  while (!rest.empty()) {
    const std::string_view one = rest.substr(0, rest.find('\n'));
    if (one.size() == rest.size()) return;
    rest.remove_prefix(one.size() + 1);
    const std::vector<CsvRecord> records = parse_csv(std::string(one) + '\n').records;
    if (!records.empty() && is_row(records.front())) {
      throw InputError(path_ + ':' + std::to_string(line) + ": a quotation mark without its end, expected a row");
    }
  }
}

// With as many columns as this or an earlier version writes.
bool CsvLog::is_row(const CsvRecord& record) const {
  const auto has_size = [&](const CsvRecord& columns) { return columns.size() == record.size(); };
  return has_size(columns_) || std::ranges::any_of(former_columns_, has_size);
}

CsvText CsvLog::parsed(std::string_view text) const {
  CsvText table = parse_csv(text);
  if (rows_ == Rows::kOfAnyText) return table;
  const std::string_view whole = text.substr(0, table.complete);
  check_rest(text.substr(table.complete), 1 + static_cast<std::size_t>(std::ranges::count(whole, '\n')));
  return table;
}

std::vector<CsvRecord> CsvLog::read() const {
  constexpr std::uint64_t kMemoryPerByte = 8;  // of what becomes of a table
  const std::string all = text(available_memory() / kMemoryPerByte);
  const std::string header = csv_line(columns_);
  const bool is_table = all.starts_with(header) || std::ranges::any_of(former_columns_, [&](const CsvRecord& columns) {
                          return all.starts_with(csv_line(columns));
                        });
  if (!is_table && header.starts_with(all)) return {};  // empty, or a header that was never completed
  if (!is_table) {
    const std::string expected = header.substr(0, header.find_last_not_of("\r\n") + 1);
    if (all.starts_with(expected + "\r\n")) throw InputError(path_ + ":1: ends with CR LF, expected LF");
    throw InputError(path_ + ":1: not written by raycone batch, expected " + expected);
  }
  std::vector<CsvRecord> rows = parsed(all).records;
  rows.erase(rows.begin());  // the header
  return rows;
}

bool CsvLog::ends_within_line() const {
  const std::string all = text();
  return parse_csv(all).complete < all.size();
}

// Where the last write(2) was cut short, because its process was killed, its line is cut off. That needs a look at the
// whole file, as fields may hold line feeds, but only where others have written to it.
off_t CsvLog::drop_incomplete_line(const Descriptor& file) const {
  const off_t size = lseek(file.number(), 0, SEEK_END);
  if (size == complete_) return size;
  const auto complete = static_cast<off_t>(parsed(text()).complete);
  if (ftruncate(file.number(), complete) != 0) fail_writing(path_, errno);
  return complete;
}

std::int64_t CsvLog::modified() const { return stamp_of(path_).modified; }

void CsvLog::append(const std::string& line) const {
  constexpr mode_t kMode = 0666;  // less the umask
  Descriptor file = open_file(path_, O_WRONLY | O_APPEND | O_CREAT, kMode);
  if (!file) fail_writing(path_, errno);
  const off_t size = drop_incomplete_line(file);
  const std::string text = (size == 0 ? csv_line(columns_) : "") + line;
  const ssize_t written = write(file.number(), text.data(), text.size());
  int error = written < 0 ? errno : ENOSPC;
  const bool complete = written == static_cast<ssize_t>(text.size());
  if (!complete && written > 0 && ftruncate(file.number(), size) != 0) error = errno;
  if (close(file.release()) != 0 && complete && errno != EINTR) fail_writing(path_, errno);
  if (!complete) fail_writing(path_, error);
  complete_ = size + written;
}

void CsvLog::replace(const std::vector<std::string>& lines) const {
  std::string wanted = csv_line(columns_);
  for (const std::string& line : lines) wanted += line;
  if (text() == wanted) return sync();
  OutputFile file(path_);
  write_all(file, wanted);
}

void CsvLog::sync() const {
  const Descriptor file = open_file(path_, O_RDONLY);
  if (!file) return;  // there is none
  if (!write_to_disk(file)) fail_writing(path_, errno);
}

}  // namespace raycone
