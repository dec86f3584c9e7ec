// By nlohmann-json: it escapes names correctly and prints doubles shortest-round-trip.
#include "app/report/json.h"

#include <nlohmann/json.hpp>

#include "app/process/version.h"

namespace raycone {
namespace {

using Json = nlohmann::ordered_json;

Json to_array(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

Json to_object(const Lattice& lattice) {
  return {{"origin", to_array(lattice.origin)},
          {"spacing", to_array(lattice.spacing)},
          {"index_min", lattice.index_min},
          {"index_max", Json::array({lattice.index_max(0), lattice.index_max(1), lattice.index_max(2)})}};
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
  return object;
}

// File names may hold any bytes; JSON is UTF-8.
std::string to_text(const Json& document) {
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string to_json(const RunReport& report) {
  Json document{{"version", kVersion},
                {"mesh", report.mesh},
                {"sha256", report.sha256},
                {"output", report.output},
                {"vertices", report.vertices},
                {"faces", report.faces},
                {"flipped_faces", report.orientation.flipped_faces},
                {"dropped_duplicates", report.orientation.dropped_duplicates},
                {"patches", report.orientation.patches},
                {"exterior_edges", report.exterior_edges},
                {"samples", report.samples},
                {"lattice", nullptr},
                {"threads", report.threads},
                {"degenerate", report.tally.degenerate},
                {"on_surface", report.tally.on_surface},
                {"peak_memory_bytes", report.peak_memory_bytes},
                {"warnings", report.warnings},
                {"seconds", to_object(report.seconds)}};
  if (report.lattice) document["lattice"] = to_object(*report.lattice);
  if (report.verification) document["verify"] = to_object(*report.verification);
  return to_text(document);
}

std::string to_json(const MeshInfo& info) {
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
                {"skipped_faces", info.skipped_faces}};
  if (s.signed_volume) document["signed_volume"] = *s.signed_volume;
  return to_text(document);
}

}  // namespace raycone
