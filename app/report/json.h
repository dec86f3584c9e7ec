// Reports for machines, as documents of JSON: UTF-8, numbers that round-trip, a line feed at the end.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/report/info.h"
#include "app/report/run_report.h"
#include "app/report/volume_info.h"
#include "app/text/csv.h"

namespace raycone {

[[nodiscard]] std::string to_json(const RunReport& report);
[[nodiscard]] std::string to_json(const MeshInfo& info);

// How a file was made, in one line, without line feed: the version, the hash of the mesh, the options that were
// given, the fields, their rule (where it is not empty), the transform. The same whatever files are called.
[[nodiscard]] std::string provenance_json(const RunReport& report, const std::vector<std::string>& fields,
                                          const std::string& rule);

// The names of the labels 1, 2, ... of a run, as an array in one line.
[[nodiscard]] std::string label_names_json(const RunReport& report);

// The labels of a run for programs that show them: of each its number, name, and a colour that depends on the number
// alone.
[[nodiscard]] std::string label_table_json(const RunReport& report);

// An object that names its mesh first, to be put into an array; no line feed at the end.
[[nodiscard]] std::string to_json_item(const MeshInfo& info);

// What a file of values says about itself; as an item of an array it names its file first.
[[nodiscard]] std::string to_json(const VolumeInfo& info);
[[nodiscard]] std::string to_json_item(const VolumeInfo& info);

// How a file was made, as lines of text: a name and a value each.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> made_lines(const VolumeFacts& facts);

// The facts of to_json() as a row of a table, behind the mesh's name: the keys of the JSON, `bounds` as x0 to z1,
// nothing for null, lists joined by semicolons. First the header, then a row.
[[nodiscard]] CsvRecord csv_names(const MeshInfo& info);
[[nodiscard]] CsvRecord csv_values(const MeshInfo& info);

}  // namespace raycone
