#include "app/batch/hash_inputs.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "app/batch/file_stamp.h"
#include "app/input/run_limits.h"
#include "app/options/batch_command.h"
#include "io/files/file_error.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

const MeshOptions& mesh_of(const MeshCommand& command) {
  return std::visit([](const auto& one) -> const MeshOptions& { return one.mesh; }, command);
}

const RunOptions& run_of(const MeshCommand& command) {
  return std::visit([](const auto& one) -> const RunOptions& { return one.run; }, command);
}

// The buffers of a mesh that could not be evaluated, as they were at `time`; nothing where they cannot be told.
std::optional<std::vector<StampedFile>> buffers_of(const MeshOptions& mesh, const RunOptions& run, std::int64_t time) {
  std::vector<StampedFile> buffers;
  try {
    const auto files = [&mesh](const RunLimits&) { return files_referred_to(mesh.path, mesh.reading); };
    for (const std::string& path : within_limits(run, mesh.path, files)) {
      buffers.push_back(file_as_at(path, time));
      buffers.back().path = relative_to_mesh(path, mesh.path);
    }
    return buffers;
  } catch (const UnreadableError&) {
    return std::nullopt;
  } catch (const InputError&) {
    return buffers;  // it fails whatever there is beside it
  } catch (const LimitError&) {
    return may_refer_to_files(mesh.path, mesh.reading) ? std::nullopt : std::optional(buffers);
  }
}

}  // namespace

JobResult hash_inputs(const InputsRequest& request) {
  JobResult result;
  result.row.status = MeshStatus::kInvalid;  // it has no figures
  const MeshOptions& mesh = mesh_of(request.command);
  const std::string content = hash_of_file(mesh.path);
  std::error_code error;
  const bool is_file = std::filesystem::is_regular_file(mesh.path, error);
  std::optional<std::vector<StampedFile>> buffers{std::in_place};
  if (is_file) buffers = buffers_of(mesh, run_of(request.command), request.started);
  const bool is_same = (content != kNoFile || !is_file) && stamp_of(mesh.path) == request.stamp;
  result.knows_inputs = is_same && buffers;
  if (!result.knows_inputs) return result;
  if (is_file) result.row.sha256 = content;
  result.buffers = std::move(*buffers);
  if (const GridReference* const grid = grid_of(request.command)) {
    result.grid = file_as_at(grid->path, request.started).sha256;
  }
  return result;
}

}  // namespace raycone
