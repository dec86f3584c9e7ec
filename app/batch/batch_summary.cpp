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

std::string pruned_line(std::size_t count) {
  const std::string rows =
      count == 1 ? "1 row of a mesh that is gone" : std::to_string(count) + " rows of meshes that are gone";
  return rows + " removed, outputs left as they are";
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

bool BatchOutcome::any_failed() const { return count_failed(evaluated) + count_failed(kept) > 0; }

std::vector<std::string> summary_lines(const BatchOutcome& outcome) {
  std::vector<std::string> lines = slowest_lines(outcome.evaluated);
  lines.push_back(evaluated_line(outcome));
  if (!outcome.kept.empty()) lines.push_back(kept_line(outcome.kept));
  if (outcome.pruned > 0) lines.push_back(pruned_line(outcome.pruned));
  if (outcome.not_done > 0) lines.push_back(std::to_string(outcome.not_done) + " not done");
  return lines;
}

}  // namespace raycone
