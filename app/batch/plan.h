// What of a batch is to be done: all that is missing or out of date, and nothing else.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "app/batch/batch_meshes.h"
#include "app/batch/batch_record.h"

namespace raycone {

struct PlanOptions {
  // Paths of all files that a job writes for this mesh: none where it only measures.
  std::function<std::vector<std::string>(const BatchMesh&)> written;
  bool writes = true;  // outputs, not just measurements
  bool retry_failed = false;
  // What is done to a mesh, as rows remember it.
  std::string version;
  std::string options;
  std::uint64_t memory_limit = 0;  // bytes
  bool default_memory_limit = false;
  double timeout = 0.0;  // seconds
};

struct PlannedMesh {
  BatchMesh mesh;
  std::string reason;        // "new", "mesh changed", ...
  std::int64_t earlier = 0;  // when the row was finished that is to be replaced; 0 where there is none
};

struct Plan {
  std::vector<PlannedMesh> todo;
  BatchRecords kept;  // of the meshes that need nothing, their stamps brought up to date
};

// Reads the files whose stamp changed, to see whether their content did.
[[nodiscard]] Plan make_plan(const std::vector<BatchMesh>& meshes, const BatchRecords& records,
                             const PlanOptions& options);

}  // namespace raycone
