#include "app/batch/result_row.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <variant>

#include "app/text/parse_value.h"

namespace raycone {
namespace {

constexpr std::array kStatusNames{"ok", "invalid", "timeout", "memory", "crashed", "unwritable"};

struct ResultColumn {
  const char* name;
  std::variant<std::string ResultRow::*, MeshStatus ResultRow::*, int ResultRow::*, std::uint64_t MeshFigures::*,
               double MeshFigures::*>
      member;
};

constexpr std::array kResultColumns{
    ResultColumn{"mesh", &ResultRow::mesh},
    ResultColumn{"status", &ResultRow::status},
    ResultColumn{"exit", &ResultRow::exit},
    ResultColumn{"faces", &MeshFigures::faces},
    ResultColumn{"exterior_edges", &MeshFigures::exterior_edges},
    ResultColumn{"samples", &MeshFigures::samples},
    ResultColumn{"degenerate", &MeshFigures::degenerate},
    ResultColumn{"on_surface", &MeshFigures::on_surface},
    ResultColumn{"read_s", &MeshFigures::read_s},
    ResultColumn{"prepare_s", &MeshFigures::prepare_s},
    ResultColumn{"evaluate_s", &MeshFigures::evaluate_s},
    ResultColumn{"write_s", &MeshFigures::write_s},
    ResultColumn{"peak_memory_bytes", &MeshFigures::peak_memory_bytes},
    ResultColumn{"output", &ResultRow::output},
    ResultColumn{"sha256", &ResultRow::sha256},
    ResultColumn{"message", &ResultRow::message},
    ResultColumn{"warnings", &ResultRow::warnings},
    ResultColumn{"flipped_faces", &MeshFigures::flipped_faces},
    ResultColumn{"dropped_duplicates", &MeshFigures::dropped_duplicates},
    ResultColumn{"patches", &MeshFigures::patches},
};
constexpr std::size_t kFormerColumns = 16;  // up to "message"

// --- From values to text --------------------------------------------------------------------------------------------

std::string to_field(const std::string& text) { return text; }
std::string to_field(MeshStatus status) { return name_of(status); }
std::string to_field(int number) { return std::to_string(number); }
std::string to_field(std::uint64_t count) { return std::to_string(count); }
std::string to_field(double seconds) {
  char text[48];
  std::snprintf(text, sizeof text, "%.9f", seconds);
  return text;
}

template <typename Value>
std::string field_of(const ResultRow& row, Value ResultRow::*member) {
  return to_field(row.*member);
}

template <typename Value>
std::string field_of(const ResultRow& row, Value MeshFigures::*member) {
  return row.figures ? to_field((*row.figures).*member) : "";
}

// --- Back: false where the text is no such value --------------------------------------------------------------------

bool from_field(const std::string& text, std::string& value) {
  value = text;
  return true;
}

bool from_field(const std::string& text, MeshStatus& status) {
  const auto found = std::ranges::find(kStatusNames, text);
  status = static_cast<MeshStatus>(found - kStatusNames.begin());
  return found != kStatusNames.end();
}

bool from_field(const std::string& text, int& number) {
  const std::optional<std::int64_t> value = integer_from(text);
  number = static_cast<int>(value.value_or(0));
  return value.has_value();
}

bool from_field(const std::string& text, std::uint64_t& count) {
  const std::optional<std::int64_t> value = integer_from(text);
  count = static_cast<std::uint64_t>(value.value_or(0));
  return value && *value >= 0;
}

bool from_field(const std::string& text, double& number) {
  const std::optional<double> value = number_from(text);
  number = value.value_or(0.0);
  return value.has_value();
}

template <typename Value>
bool set_field(ResultRow& row, Value ResultRow::*member, const std::string& text) {
  return from_field(text, row.*member);
}

// Figures are there only where all of them are.
template <typename Value>
bool set_field(ResultRow& row, Value MeshFigures::*member, const std::string& text) {
  if (row.figures && !from_field(text, (*row.figures).*member)) row.figures.reset();
  return true;
}

}  // namespace

std::string name_of(MeshStatus status) { return kStatusNames[static_cast<std::size_t>(status)]; }

const CsvRecord& result_columns() {
  static const CsvRecord columns = [] {
    CsvRecord names;
    for (const ResultColumn& column : kResultColumns) names.emplace_back(column.name);
    return names;
  }();
  return columns;
}

CsvRecord former_result_columns() { return {result_columns().begin(), result_columns().begin() + kFormerColumns}; }

CsvRecord to_record(const ResultRow& row) {
  CsvRecord record;
  for (const ResultColumn& column : kResultColumns) {
    record.push_back(std::visit([&](auto member) { return field_of(row, member); }, column.member));
  }
  return record;
}

std::optional<ResultRow> row_from(CsvRecord record) {
  // Of the version before: no warnings with names, and no face was turned.
  if (record.size() == kFormerColumns) record.insert(record.end(), {"", "0", "0", "0"});
  if (record.size() != kResultColumns.size()) return std::nullopt;
  ResultRow row;
  row.figures.emplace();
  for (std::size_t n = 0; n < record.size(); ++n) {
    const auto set = [&](auto member) { return set_field(row, member, record[n]); };
    if (!std::visit(set, kResultColumns[n].member)) return std::nullopt;
  }
  if (row.status == MeshStatus::kOk && !row.figures) return std::nullopt;
  return row;
}

}  // namespace raycone
