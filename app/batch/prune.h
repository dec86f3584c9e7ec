// Rows of meshes that are gone: what --prune removes.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/batch/batch_meshes.h"
#include "app/batch/batch_record.h"

namespace raycone {

// Whether there is no such file. What cannot be told (a directory that may not be entered, a server that is away) is
// there.
[[nodiscard]] bool is_missing(const BatchMesh& mesh);

// Paths of meshes by their names; the name again where the path is not known.
using GoneMeshes = std::map<std::string, std::string>;

// Of the rows in `records` those whose mesh is gone: neither among `found`, nor at the path from which it was read.
[[nodiscard]] GoneMeshes gone_meshes(const BatchRecords& records, const std::vector<BatchMesh>& found);

}  // namespace raycone
