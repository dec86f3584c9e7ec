#include "app/batch/batch_summary.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include "app/process/progress.h"
#include "io/files/counted.h"

namespace raycone {
namespace {

std::size_t count_failed(const BatchRecords& records) {
  return static_cast<std::size_t>(
      std::ranges::count_if(records, [](const auto& record) { return record.second.row.status != MeshStatus::kOk; }));
}

// " (2 invalid, 1 timeout)"; empty where none failed.
std::string failures_by_cause(const BatchRecords& records) {
  std::map<MeshStatus, std::size_t> counts;
  for (const auto& [mesh, record] : records) {
    if (record.row.status != MeshStatus::kOk) ++counts[record.row.status];
  }
  std::string text;
  for (const auto& [status, count] : counts) {
    text += (text.empty() ? " (" : ", ") + std::to_string(count) + ' ' + name_of(status);
  }
  return text.empty() ? "" : text + ')';
}

std::string evaluated_line(const BatchOutcome& outcome) {
  const std::size_t failed = count_failed(outcome.evaluated);
  double samples = 0.0;
  for (const auto& [mesh, record] : outcome.evaluated) {
    if (record.row.figures) samples += static_cast<double>(record.row.figures->samples);
  }
  char time[64];
  std::snprintf(time, sizeof time, " in %.2f s", outcome.seconds);
  const std::size_t done = outcome.evaluated.size() - failed;
  std::string line = counted(done, "mesh") + " done, " + std::to_string(failed) + " failed" +
                     failures_by_cause(outcome.evaluated) + time;
  if (outcome.seconds > 0.0) line += ", " + readable_count(samples / outcome.seconds) + "samples/s";
  return line;
}

std::string kept_line(const BatchRecords& kept) {
  const std::string by_cause = failures_by_cause(kept);
  return std::to_string(kept.size()) + " skipped: up to date" +
         (by_cause.empty() ? "" : ", of which " + std::to_string(count_failed(kept)) + " failed earlier" + by_cause);
}

std::vector<std::string> slowest_lines(const BatchRecords& records) {
  constexpr std::size_t kSlowest = 10;
  std::vector<std::pair<double, std::string>> times;
  for (const auto& [mesh, record] : records) {
    if (record.row.figures) times.emplace_back(record.row.figures->seconds(), mesh);
  }
  const auto shown = static_cast<std::ptrdiff_t>(std::min(times.size(), kSlowest));
  std::ranges::partial_sort(times, times.begin() + shown, std::greater<>());
  std::vector<std::string> lines;
  for (auto time = times.begin(); time != times.begin() + shown; ++time) {
    char text[64];
    std::snprintf(text, sizeof text, "slowest: %9.3f s  ", time->first);
    lines.push_back(text + time->second);
  }
  return lines;
}

}  // namespace

void BatchProgress::add(bool failed, double part) {
  ++done_;
  failed_ += failed ? 1 : 0;
  part_ = part;
  show();
}

void BatchProgress::show() {
  if (!shown_) return;
  const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  std::string line = std::to_string(done_) + '/' + counted(meshes_, "mesh");
  if (elapsed > 0.0) line += "  " + readable_count(static_cast<double>(done_) / elapsed) + "meshes/s";
  if (part_ > 0.0) line += "  " + readable_time(elapsed * (1.0 - part_) / part_) + " left";
  if (failed_ > 0) line += "  " + std::to_string(failed_) + " failed";
  std::fprintf(stderr, "\r\033[K%s", line.c_str());
  std::fflush(stderr);
  drawn_ = true;
}

void BatchProgress::erase() {
  if (std::exchange(drawn_, false)) std::fputs("\r\033[K", stderr);
}

bool BatchOutcome::any_failed() const { return count_failed(evaluated) + count_failed(kept) > 0; }

std::vector<std::string> summary_lines(const BatchOutcome& outcome) {
  std::vector<std::string> lines = slowest_lines(outcome.evaluated);
  lines.push_back(evaluated_line(outcome));
  if (!outcome.kept.empty()) lines.push_back(kept_line(outcome.kept));
  if (outcome.not_done > 0) lines.push_back(std::to_string(outcome.not_done) + " not done");
  return lines;
}

}  // namespace raycone
