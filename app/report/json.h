// Reports for machines, as documents of JSON: UTF-8, numbers that round-trip, a line feed at the end.
#pragma once

#include <string>

#include "app/report/info.h"
#include "app/report/run_report.h"

namespace raycone {

[[nodiscard]] std::string to_json(const RunReport& report);
[[nodiscard]] std::string to_json(const MeshInfo& info);

}  // namespace raycone
