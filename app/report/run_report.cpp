#include "app/report/run_report.h"

#include <algorithm>
#include <cstdio>

#include "io/files/counted.h"

namespace raycone {
namespace {

std::string verification_clause(const Verification& verification) {
  char difference[64];
  std::snprintf(difference, sizeof difference, ", largest difference %.2g", verification.largest_difference);
  std::string clause = ", verified " + counted(verification.samples, "sample") + difference;
  if (verification.largest_distance_difference) {
    std::snprintf(difference, sizeof difference, " (of distances %.2g)", *verification.largest_distance_difference);
    clause += difference;
  }
  if (verification.largest_gradient_difference) {
    std::snprintf(difference, sizeof difference, " (of gradients %.2g)", *verification.largest_gradient_difference);
    clause += difference;
  }
  if (verification.unresolved > 0) clause += ", skipped " + std::to_string(verification.unresolved) + " unresolved";
  return clause;
}

std::string parts_clause(const std::vector<PartReport>& parts) {
  return parts.empty() ? "" : ", " + counted(parts.size(), "part");
}

std::string surface_clause(const std::optional<SurfaceReport>& surface) {
  return surface ? ", surface of " + counted(surface->faces, "face") : "";
}

}  // namespace

void Verification::merge(const Verification& other) {
  samples = std::min(samples, other.samples);
  on_surface = std::max(on_surface, other.on_surface);
  unresolved = std::max(unresolved, other.unresolved);
  largest_difference = std::max(largest_difference, other.largest_difference);
  largest_bound = std::max(largest_bound, other.largest_bound);
  largest_distance_difference = std::max(largest_distance_difference, other.largest_distance_difference);
  largest_gradient_difference = std::max(largest_gradient_difference, other.largest_gradient_difference);
}

void RunReport::add_verification(const Verification& found) {
  if (verification) {
    verification->merge(found);
  } else {
    verification = found;
  }
}

std::string summary_line(const RunReport& report) {
  const Seconds& s = report.seconds;
  char times[160];
  std::snprintf(times, sizeof times, " in %.2f s (read %.2f, prepare %.2f, evaluate %.2f, write %.2f", s.total, s.read,
                s.prepare, s.evaluate, s.write);
  char verify[32] = "";
  if (report.verification) std::snprintf(verify, sizeof verify, ", verify %.2f", s.verify);
  const std::size_t further = report.meshes.size() > 1 ? report.meshes.size() - 1 : 0;
  const std::string meshes = report.mesh + (further > 0 ? " and " + std::to_string(further) + " more" : "");
  return meshes + ": " + counted(report.faces, "face") + ", " + counted(report.exterior_edges, "exterior edge") + ", " +
         counted(report.samples, "sample") + parts_clause(report.parts) + surface_clause(report.surface) + times +
         verify + ") -> " + (report.output == "-" ? "standard output" : report.output) +
         (report.verification ? verification_clause(*report.verification) : "");
}

}  // namespace raycone
