// By nlohmann-json: it escapes names correctly and prints doubles shortest-round-trip.
#include "app/report/json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/process/version.h"
#include "io/fields/label_colour.h"

namespace raycone {
namespace {

using Json = nlohmann::ordered_json;

Json to_array(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

Json to_rows(const std::array<double, 16>& matrix) {
  Json rows = Json::array();
  for (std::size_t n = 0; n < 16; n += 4) {
    rows.push_back(Json::array({matrix[n], matrix[n + 1], matrix[n + 2], matrix[n + 3]}));
  }
  return rows;
}

// Only a lattice that is not along the axes has a direction.
Json to_object(const PlacedLattice& placed) {
  const Lattice& lattice = placed.grid;
  Json object{{"origin", to_array(placed.origin)},
              {"spacing", to_array(lattice.spacing)},
              {"index_min", lattice.index_min},
              {"index_max", Json::array({lattice.index_max(0), lattice.index_max(1), lattice.index_max(2)})}};
  if (placed.along_axes()) return object;
  const std::array<double, 9> d = placed.direction();
  object["direction"] = Json::array({{d[0], d[1], d[2]}, {d[3], d[4], d[5]}, {d[6], d[7], d[8]}});
  return object;
}

Json to_object(const Seconds& seconds) {
  return {{"read", seconds.read},
          {"prepare", seconds.prepare},
          {"evaluate", seconds.evaluate},
          {"write", seconds.write},
          {"total", seconds.total}};
}

Json to_object(const Verification& verification) {
  Json object = {{"samples", verification.samples},
                 {"on_surface", verification.on_surface},
                 {"unresolved", verification.unresolved},
                 {"largest_difference", verification.largest_difference},
                 {"largest_bound", verification.largest_bound}};
  if (verification.largest_distance_difference) {
    object["largest_distance_difference"] = *verification.largest_distance_difference;
  }
  if (verification.largest_gradient_difference) {
    object["largest_gradient_difference"] = *verification.largest_gradient_difference;
  }
  return object;
}

// That the surface is closed and manifold is not asked here: it was checked, and one with a fault is never written.
Json to_object(const SurfaceReport& surface) {
  return {{"vertices", surface.vertices},
          {"faces", surface.faces},
          {"components", surface.components},
          {"closed", true},
          {"manifold", true},
          {"self_intersections", 0},
          {"max_distance", surface.max_distance},
          {"hole_area", surface.hole_area},
          {"dropped_area", surface.dropped_area}};
}

// The names of parts or warnings.
template <class Named>
Json names_of(const std::vector<Named>& all) {
  Json names = Json::array();
  for (const Named& one : all) names.push_back(one.name);
  return names;
}

Json to_array(const std::vector<PartReport>& parts) {
  Json array = Json::array();
  for (const PartReport& part : parts) {
    array.push_back({{"label", array.size() + 1},
                     {"name", part.name},
                     {"mesh", part.mesh},
                     {"faces", part.faces},
                     {"exterior_edges", part.exterior_edges},
                     {"samples", part.samples}});
  }
  return array;
}

Json to_array(const std::vector<FileRead>& meshes) {
  Json array = Json::array();
  for (const FileRead& mesh : meshes) array.push_back({{"mesh", mesh.path}, {"sha256", mesh.sha256}});
  return array;
}

Json lines_of(const std::vector<Warning>& warnings) {
  Json lines = Json::array();
  for (const Warning& warning : warnings) lines.push_back(line_of(warning));
  return lines;
}

// Nothing for what overflows, for which JSON has no number.
Json finite(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

Json to_object(const MeshInfo& info) {
  const MeshStatistics& s = info.statistics;
  Json document{{"faces", info.faces},
                {"vertices", info.vertices},
                {"welded_vertices", info.welded_vertices},
                {"exterior_edges", s.exterior_edges},
                {"closed", s.closed()},
                {"components", s.components},
                {"degenerate_faces", s.degenerate_faces},
                {"duplicate_faces", s.duplicate_faces},
                {"nonmanifold_edges", s.nonmanifold_edges},
                {"inconsistent_edges", s.inconsistent_edges},
                {"bounds", Json::array({to_array(info.bounds.lower), to_array(info.bounds.upper)})},
                {"signed_volume", nullptr},
                {"surface_area", finite(s.surface_area)},
                {"skipped_faces", info.skipped_faces},
                {"opposite_duplicate_faces", info.opposite_duplicate_faces},
                {"warnings", names_of(info.warnings)},
                {"warning_lines", lines_of(info.warnings)}};
  if (s.signed_volume) document["signed_volume"] = finite(*s.signed_volume);
  if (!info.unit.empty()) document["unit"] = info.unit;
  if (info.intersections) document["self_intersections"] = info.intersections->pairs.value_or(0);
  return document;
}

// The names and values of the columns of a table: `bounds` is six, lists are joined by semicolons.
struct Cell {
  std::string name, value;
};
std::vector<Cell> cells_of(const Json& document) {
  const auto text = [](const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); };
  std::vector<Cell> cells;
  for (const auto& [key, value] : document.items()) {
    if (key == "bounds") {
      for (const std::size_t end : {0U, 1U}) {
        for (const std::size_t axis : {0U, 1U, 2U}) {
          cells.push_back({std::string(1, "xyz"[axis]) + std::to_string(end), value[end][axis].dump()});
        }
      }
    } else if (value.is_array()) {
      std::string joined;
      for (const Json& item : value) joined += (joined.empty() ? "" : ";") + text(item);
      cells.push_back({key, joined});
    } else {
      cells.push_back({key, value.is_null() ? "" : text(value)});
    }
  }
  return cells;
}

// Whether a stranger's JSON is as simple as what raycone writes. Deep nesting takes stack, and the library's ordered
// objects look for each member among all before it.
class SimpleJson final : public nlohmann::json_sax<Json> {
 public:
  [[nodiscard]] static bool is(const std::string& text) {
    SimpleJson check;
    return Json::sax_parse(text, &check);
  }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(std::int64_t) override { return true; }
  bool number_unsigned(std::uint64_t) override { return true; }
  bool number_float(double, const std::string&) override { return true; }
  bool string(std::string&) override { return true; }
  bool binary(Json::binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_array() override { return close(); }
  bool key(std::string&) override { return ++members_.back() <= kMostMembers; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  static constexpr std::size_t kDeepest = 8, kMostMembers = 1000;

  bool open() {
    members_.push_back(0);
    return members_.size() <= kDeepest;
  }
  bool close() {
    members_.pop_back();
    return true;
  }

  std::vector<std::size_t> members_;  // of the objects and arrays that are open
};

// How a file was made, whoever wrote it: what is no object, or not simple, is left out.
Json made_object(const VolumeFacts& facts) {
  const auto parsed = [](const std::string& text) { return SimpleJson::is(text) ? Json::parse(text) : Json(); };
  Json object = facts.made_json.empty() ? Json::object() : parsed(facts.made_json);
  if (!object.is_object()) object = Json::object();
  for (const MadeFact& fact : facts.made) object[fact.key] = fact.is_json ? parsed(fact.value) : Json(fact.value);
  return object;
}

// The object of a mesh for a table: all meshes have the same columns, whatever their format.
Json to_row(const MeshInfo& info) {
  Json row = to_object(info);
  row.erase("unit");
  return row;
}

Json to_object(const VolumeFacts& facts) {
  Json arrays = Json::array();
  for (const ArrayFacts& array : facts.arrays) {
    Json entry{{"name", array.name}, {"type", array.type}};
    if (facts.format != "OpenVDB") entry["shape"] = array.shape;
    arrays.push_back(entry);
  }
  Json document{{"format", facts.format}, {"arrays", arrays}, {"lattice", nullptr}, {"made", made_object(facts)}};
  if (facts.lattice) document["lattice"] = to_object(*facts.lattice);
  return document;
}

// File names may hold any bytes; JSON is UTF-8.
std::string printed(const Json& document, int indentation) {
  return document.dump(indentation, ' ', false, Json::error_handler_t::replace);
}

constexpr int kIndentation = 2, kInOneLine = -1;

std::string to_text(const Json& document) { return printed(document, kIndentation) + "\n"; }

std::string to_line(const Json& document) { return printed(document, kInOneLine); }

}  // namespace

std::string to_json(const RunReport& report) {
  Json document{{"version", kVersion},
                {"command", report.command},
                {"options", report.options},
                {"mesh", report.mesh},
                {"sha256", report.sha256},
                {"output", report.output},
                {"vertices", report.vertices},
                {"faces", report.faces},
                {"flipped_faces", report.orientation.flipped_faces},
                {"dropped_duplicates", report.orientation.dropped_duplicates},
                {"patches", report.orientation.patches},
                {"exterior_edges", report.exterior_edges},
                {"transform", to_rows(report.transform)},
                {"samples", report.samples},
                {"lattice", nullptr},
                {"threads", report.threads},
                {"degenerate", report.tally.degenerate},
                {"on_surface", report.tally.on_surface},
                {"near_terms", report.terms.near},
                {"far_terms", report.terms.far},
                {"largest_error_bound", report.largest_error_bound},
                {"peak_memory_bytes", report.peak_memory_bytes},
                {"warnings", names_of(report.warnings)},
                {"warning_lines", lines_of(report.warnings)},
                {"seconds", to_object(report.seconds)}};
  if (!report.unit.empty()) document["unit"] = report.unit;
  if (report.lattice) document["lattice"] = to_object(*report.lattice);
  if (!report.parts.empty()) {
    document["meshes"] = to_array(report.meshes);
    document["parts"] = to_array(report.parts);
  }
  if (report.surface) document["surface"] = to_object(*report.surface);
  if (report.verification) {
    document["verify"] = to_object(*report.verification);
    document["seconds"]["verify"] = report.seconds.verify;
  }
  return to_text(document);
}

std::string provenance_json(const RunReport& report, const std::vector<std::string>& fields, const std::string& rule) {
  Json document{{"raycone_version", kVersion},
                {"sha256", report.sha256},
                {"options", report.options},
                {"fields", fields},
                {"transform", to_rows(report.transform)}};
  if (!rule.empty()) document["rule"] = rule;
  if (!report.parts.empty()) document["labels"] = names_of(report.parts);
  if (report.meshes.size() > 1) {
    for (const FileRead& mesh : report.meshes) document["sha256_of_meshes"].push_back(mesh.sha256);
  }
  return to_line(document);
}

std::string label_names_json(const RunReport& report) { return to_line(names_of(report.parts)); }

std::string label_table_json(const RunReport& report) {
  Json labels = Json::array();
  for (const PartReport& part : report.parts) {
    const std::size_t label = labels.size() + 1;
    labels.push_back({{"label", label}, {"name", part.name}, {"color", label_colour(label)}});
  }
  return to_text({{"raycone_version", kVersion}, {"labels", labels}});
}

std::string to_json(const VolumeInfo& info) { return to_text(to_object(info.facts)); }

std::string to_json_item(const VolumeInfo& info) {
  Json document{{"file", info.file}};
  document.update(to_object(info.facts));
  return printed(document, kIndentation);
}

std::vector<std::pair<std::string, std::string>> made_lines(const VolumeFacts& facts) {
  std::vector<std::pair<std::string, std::string>> lines;
  const Json made = made_object(facts);
  const auto text = [](const Json& value) { return value.is_string() ? value.get<std::string>() : to_line(value); };
  const auto is_text = [](const Json& value) { return value.is_string(); };
  for (const auto& [key, value] : made.items()) {
    if (!value.is_array() || !std::ranges::all_of(value, is_text)) {
      lines.emplace_back(key, text(value));
      continue;
    }
    std::string joined;
    for (const Json& item : value) joined += (joined.empty() ? "" : " ") + text(item);
    lines.emplace_back(key, joined);
  }
  return lines;
}

std::string to_json(const MeshInfo& info) { return to_text(to_object(info)); }

std::string to_json_item(const MeshInfo& info) {
  Json document{{"mesh", info.mesh}};
  document.update(to_object(info));
  return printed(document, kIndentation);
}

CsvRecord csv_names(const MeshInfo& info) {
  CsvRecord names{"mesh"};
  for (const Cell& cell : cells_of(to_row(info))) names.push_back(cell.name);
  return names;
}

CsvRecord csv_values(const MeshInfo& info) {
  CsvRecord values{info.mesh};
  for (const Cell& cell : cells_of(to_row(info))) values.push_back(cell.value);
  return values;
}

}  // namespace raycone
