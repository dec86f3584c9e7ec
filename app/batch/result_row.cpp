#include "app/batch/result_row.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>

#include "app/text/parse_value.h"

namespace raycone {
namespace {

constexpr std::array kStatusNames{"ok", "invalid", "timeout", "memory", "crashed", "unwritable"};

// The columns between `exit` and `output`.
constexpr std::size_t kFirstFigure = 3;
constexpr std::size_t kFigures = 10;
constexpr std::size_t kFormerColumns = 16;
// The columns at the end.
constexpr std::size_t kFirstOrientationFigure = 17;
constexpr std::size_t kOrientationFigures = 3;

std::string seconds_text(double seconds) {
  char text[48];
  std::snprintf(text, sizeof text, "%.9f", seconds);
  return text;
}

CsvRecord to_fields(const MeshFigures& f) {
  return {std::to_string(f.faces),      std::to_string(f.exterior_edges),
          std::to_string(f.samples),    std::to_string(f.degenerate),
          std::to_string(f.on_surface), seconds_text(f.read_s),
          seconds_text(f.prepare_s),    seconds_text(f.evaluate_s),
          seconds_text(f.write_s),      std::to_string(f.peak_memory_bytes)};
}

CsvRecord orientation_fields(const MeshFigures& f) {
  return {std::to_string(f.flipped_faces), std::to_string(f.dropped_duplicates), std::to_string(f.patches)};
}

// Reads the fields of a record one after the other; `valid` is false once one of them is no number.
class FigureReader {
 public:
  FigureReader(const CsvRecord& record, std::size_t first) : record_(record), next_(first) {}

  std::uint64_t count() {
    const std::optional<std::int64_t> number = integer_from(record_[next_++]);
    valid_ = valid_ && number && *number >= 0;
    return static_cast<std::uint64_t>(number.value_or(0));
  }
  double number() {
    const std::optional<double> value = number_from(record_[next_++]);
    valid_ = valid_ && value;
    return value.value_or(0.0);
  }
  [[nodiscard]] bool valid() const { return valid_; }

 private:
  const CsvRecord& record_;
  std::size_t next_;
  bool valid_ = true;
};

std::optional<MeshFigures> figures_from(const CsvRecord& record) {
  FigureReader fields(record, kFirstFigure);
  MeshFigures f;
  for (std::uint64_t* const count : {&f.faces, &f.exterior_edges, &f.samples, &f.degenerate, &f.on_surface}) {
    *count = fields.count();
  }
  for (double* const seconds : {&f.read_s, &f.prepare_s, &f.evaluate_s, &f.write_s}) *seconds = fields.number();
  f.peak_memory_bytes = fields.count();
  FigureReader last(record, kFirstOrientationFigure);
  for (std::uint64_t* const count : {&f.flipped_faces, &f.dropped_duplicates, &f.patches}) *count = last.count();
  if (!fields.valid() || !last.valid()) return std::nullopt;
  return f;
}

}  // namespace

std::string name_of(MeshStatus status) { return kStatusNames[static_cast<std::size_t>(status)]; }

const CsvRecord& result_columns() {
  static const CsvRecord columns{"mesh",
                                 "status",
                                 "exit",
                                 "faces",
                                 "exterior_edges",
                                 "samples",
                                 "degenerate",
                                 "on_surface",
                                 "read_s",
                                 "prepare_s",
                                 "evaluate_s",
                                 "write_s",
                                 "peak_memory_bytes",
                                 "output",
                                 "sha256",
                                 "message",
                                 "warnings",
                                 "flipped_faces",
                                 "dropped_duplicates",
                                 "patches"};
  return columns;
}

CsvRecord former_result_columns() { return {result_columns().begin(), result_columns().begin() + kFormerColumns}; }

CsvRecord to_record(const ResultRow& row) {
  CsvRecord record{row.mesh, name_of(row.status), std::to_string(row.exit)};
  const CsvRecord figures = row.figures ? to_fields(*row.figures) : CsvRecord(kFigures);
  record.insert(record.end(), figures.begin(), figures.end());
  record.insert(record.end(), {row.output, row.sha256, row.message, row.warnings});
  const CsvRecord orientation = row.figures ? orientation_fields(*row.figures) : CsvRecord(kOrientationFigures);
  record.insert(record.end(), orientation.begin(), orientation.end());
  return record;
}

std::optional<ResultRow> row_from(CsvRecord record) {
  // Of the version before: no warnings with names, and no face was turned.
  if (record.size() == kFormerColumns) record.insert(record.end(), {"", "0", "0", "0"});
  if (record.size() != result_columns().size()) return std::nullopt;
  const auto status = std::ranges::find(kStatusNames, record[1]);
  const std::optional<std::int64_t> exit = integer_from(record[2]);
  if (status == kStatusNames.end() || !exit) return std::nullopt;
  ResultRow row;
  row.mesh = record[0];
  row.status = static_cast<MeshStatus>(status - kStatusNames.begin());
  row.exit = static_cast<int>(*exit);
  row.figures = figures_from(record);
  constexpr std::size_t kBehindFigures = kFirstFigure + kFigures;
  row.output = record[kBehindFigures];
  row.sha256 = record[kBehindFigures + 1];
  row.message = record[kBehindFigures + 2];
  row.warnings = record[kBehindFigures + 3];
  if (row.status == MeshStatus::kOk && !row.figures) return std::nullopt;
  return row;
}

}  // namespace raycone
