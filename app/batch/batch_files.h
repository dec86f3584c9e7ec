// The files of a batch: what it writes for each mesh, kept apart from what it reads.
#pragma once

#include <string>
#include <vector>

#include "app/batch/batch_meshes.h"
#include "app/options/batch_command.h"

namespace raycone {

// All that a job writes for a mesh, its output first; nothing where only measurements are asked for.
[[nodiscard]] std::vector<std::string> paths_written(const BatchCommand& command, const BatchMesh& mesh);

// Throws UsageError where what is written for one of `meshes` would replace an input of this or another one, by
// whatever names, or go where links lead what is written for another one.
void refuse_to_replace(const BatchCommand& command, const std::vector<BatchMesh>& meshes);

}  // namespace raycone
