#include "app/batch/batch_summary.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "app/text/readable_count.h"
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

std::string of_evaluated(const BatchOutcome& outcome) {
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
  if (outcome.seconds > 0.0) line += ", " + readable_count(samples / outcome.seconds, "samples/s");
  return line;
}

std::string of_kept(const BatchRecords& kept) {
  const std::string by_cause = failures_by_cause(kept);
  return std::to_string(kept.size()) + " skipped: up to date" +
         (by_cause.empty() ? "" : ", of which " + std::to_string(count_failed(kept)) + " failed earlier" + by_cause);
}

std::string of_pruned(std::size_t count) {
  const std::string rows =
      count == 1 ? "1 row of a mesh that is gone" : std::to_string(count) + " rows of meshes that are gone";
  return rows + " removed, outputs left as they are";
}

}  // namespace

bool BatchOutcome::any_failed() const { return count_failed(evaluated) + count_failed(kept) > 0; }

std::string summary_line(const BatchOutcome& outcome) {
  std::string line = of_evaluated(outcome);
  if (!outcome.kept.empty()) line += "; " + of_kept(outcome.kept);
  if (outcome.pruned > 0) line += "; " + of_pruned(outcome.pruned);
  if (outcome.not_done > 0) line += "; " + std::to_string(outcome.not_done) + " not done";
  return line;
}

}  // namespace raycone
