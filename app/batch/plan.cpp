#include "app/batch/plan.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "io/files/file_identity.h"

namespace raycone {
namespace {

// Memory that is free differs from run to run; only a default limit that grew by more than this is another one.
constexpr double kMoreMemory = 1.25;

// What the record knows of the file is brought up to date.
bool mesh_changed(const BatchMesh& mesh, BatchRecord& record) {
  const FileStamp earlier = record.origin->stamp;
  record.origin->stamp = mesh.stamp;
  record.origin->path = path_from_root(mesh);
  if (is_certainly_same(earlier, mesh.stamp)) return false;
  if (!earlier.recent && earlier.size != mesh.stamp.size) return true;
  StampedFile file{mesh.path, kNoStamp, record.row.sha256};
  return !is_unchanged(file);
}

// They are beside the mesh of today, wherever the one of the record was.
bool buffers_changed(const BatchMesh& mesh, RowOrigin& origin) {
  return !std::ranges::all_of(origin.buffers, [&mesh](StampedFile& buffer) {
    StampedFile file = buffer;
    file.path = directory_of(mesh.path) + '/' + buffer.path;
    const bool unchanged = is_unchanged(file);
    buffer.stamp = file.stamp;
    return unchanged;
  });
}

bool memory_limit_changed(const RowOrigin& origin, const PlanOptions& options) {
  if (!origin.default_memory_limit || !options.default_memory_limit) return origin.memory_limit != options.memory_limit;
  return static_cast<double>(options.memory_limit) > kMoreMemory * static_cast<double>(origin.memory_limit);
}

// Another mesh may have been given the same output since, by another command, or by a batch that ran at the same time.
std::string reason_in_output(const BatchMesh& mesh, const ResultRow& row, const RowOrigin& origin,
                             const PlanOptions& options) {
  if (!options.writes) return "";
  const std::vector<std::string> paths = options.written(mesh);
  const auto is_missing_file = [](const std::string& path) {
    std::error_code error;
    return !std::filesystem::exists(path, error);
  };
  if (row.output != mesh.output || std::ranges::any_of(paths, is_missing_file)) return "output missing";
  return std::ranges::equal(paths, origin.written, {}, output_stamp_of) ? "" : "output changed";
}

// Why a mesh with a row that holds is done again; empty where it is not.
std::string reason_to_repeat(const BatchMesh& mesh, const ResultRow& row, const RowOrigin& origin,
                             const PlanOptions& options) {
  switch (row.status) {
    case MeshStatus::kOk:
      return reason_in_output(mesh, row, origin, options);
    case MeshStatus::kCrashed:
    case MeshStatus::kUnwritable:
      return name_of(row.status) + " before";
    case MeshStatus::kTimeout:
      if (origin.timeout != options.timeout) return "time limit changed";
      break;
    case MeshStatus::kMemory:
      if (memory_limit_changed(origin, options)) return "memory limit changed";
      break;
    case MeshStatus::kInvalid:
      break;
  }
  return options.retry_failed ? name_of(row.status) + " before" : "";
}

std::string reason_to_evaluate(const BatchMesh& mesh, BatchRecord& record, const PlanOptions& options) {
  if (!record.origin || record.origin->superseded) return "not known how it was made";
  if (record.origin->version != options.version) return "another version";
  const bool inputs_are_known = !record.origin->stamp.recent || !record.row.sha256.empty();
  if (!inputs_are_known) return "not known what it was read from";
  if (record.origin->options != options.options) return "options changed";
  if (mesh_changed(mesh, record)) return "mesh changed";
  if (buffers_changed(mesh, *record.origin)) return "a file that the mesh refers to changed";
  return reason_to_repeat(mesh, record.row, *record.origin, options);
}

}  // namespace

Plan make_plan(const std::vector<BatchMesh>& meshes, const BatchRecords& records, const PlanOptions& options) {
  Plan plan;
  for (const BatchMesh& mesh : meshes) {
    const auto known = records.find(mesh.name);
    if (known == records.end()) {
      plan.todo.push_back({mesh, "new"});
      continue;
    }
    BatchRecord record = known->second;
    const std::string reason = reason_to_evaluate(mesh, record, options);
    if (reason.empty()) {
      plan.kept.emplace(mesh.name, std::move(record));
    } else {
      plan.todo.push_back({mesh, reason, finished(record)});
    }
  }
  return plan;
}

}  // namespace raycone
