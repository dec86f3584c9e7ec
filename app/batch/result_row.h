// What became of one mesh: a line of results.csv.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/text/csv.h"

namespace raycone {

enum class MeshStatus { kOk, kInvalid, kTimeout, kMemory, kCrashed, kUnwritable };

// "ok", "invalid", ...
[[nodiscard]] std::string name_of(MeshStatus status);

// Known only where the mesh was evaluated.
struct MeshFigures {
  std::uint64_t faces = 0;
  std::uint64_t exterior_edges = 0;
  std::uint64_t samples = 0;
  std::uint64_t degenerate = 0;
  std::uint64_t on_surface = 0;
  double read_s = 0.0;
  double prepare_s = 0.0;
  double evaluate_s = 0.0;
  double write_s = 0.0;
  std::uint64_t peak_memory_bytes = 0;
  std::uint64_t flipped_faces = 0;  // these three: by --orient
  std::uint64_t dropped_duplicates = 0;
  std::uint64_t patches = 0;

  [[nodiscard]] double seconds() const { return read_s + prepare_s + evaluate_s + write_s; }
};

struct ResultRow {
  std::string mesh;  // relative to the directory given, or the file's own name
  MeshStatus status = MeshStatus::kOk;
  int exit = 0;  // status of the process that evaluated it alone; 128 + N where signal N ended it
  std::optional<MeshFigures> figures;
  std::string output;    // relative to the directory of outputs; empty where nothing was written
  std::string sha256;    // of the mesh; empty where unknown
  std::string message;   // error or warnings, one line
  std::string warnings;  // their names, separated by spaces
};

// The names of the columns.
[[nodiscard]] const CsvRecord& result_columns();
// The first of them: those of version 1.0.0~rc2 and before.
[[nodiscard]] CsvRecord former_result_columns();

[[nodiscard]] CsvRecord to_record(const ResultRow& row);
// Nothing where it is no row, also of former columns.
[[nodiscard]] std::optional<ResultRow> row_from(CsvRecord record);

}  // namespace raycone
