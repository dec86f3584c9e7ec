// Text for people; machines take json.h.
#include "app/report/info.h"

#include <cstddef>
#include <cstdio>
#include <utility>

#include "app/text/plain_text.h"
#include "app/text/readable_count.h"
#include "io/files/ascii.h"
#include "io/files/counted.h"

namespace raycone {
namespace {

std::string readable_seconds(double seconds) {
  char text[48];
  if (seconds < 0.1) {
    std::snprintf(text, sizeof text, "less than 0.1 s");
  } else if (seconds < 120.0) {
    std::snprintf(text, sizeof text, seconds < 99.5 ? "about %.2g s" : "about %.0f s", seconds);
  } else if (seconds < 7200.0) {
    std::snprintf(text, sizeof text, "about %.0f minutes", seconds / 60.0);
  } else {
    const double hours = seconds / 3600.0;
    std::snprintf(text, sizeof text, hours < 999.5 ? "about %.3g hours" : "about %.0f hours", hours);
  }
  return text;
}

std::string cost_of(const CostedLattice& costed, int threads) {
  const auto [nx, ny, nz] = costed.lattice.counts;
  std::string time = readable_seconds(costed.seconds / threads);
  if (costed.at_most && time.starts_with("about ")) time.replace(0, 6, "at most ");
  return time + " for " + std::to_string(nx) + " x " + std::to_string(ny) + " x " + std::to_string(nz) + " samples";
}

std::string intersections_of(const IntersectionInfo& found) {
  if (found.pairs) return grouped(*found.pairs) + (*found.pairs == 1 ? " pair of faces" : " pairs of faces");
  return "some; --intersections counts them";
}

std::string turned_by(const OrientationCounts& counts) {
  const auto number = [](std::uint64_t count, const char* one, const char* many) {
    return grouped(count) + (count == 1 ? one : many);
  };
  return number(counts.flipped_faces, " face", " faces") + ", in " + number(counts.patches, " patch", " patches") +
         "; " + number(counts.dropped_duplicates, " duplicate", " duplicates") + " left out";
}

}  // namespace

void InfoTable::row(const std::string& name, const std::string& value) {
  constexpr std::size_t kWidth = 20;
  text_ += "  " + name + std::string(name.size() < kWidth ? kWidth - name.size() : 0, ' ') + ' ' + value + "\n";
}

std::string printed_point(const Vec3& point) {
  return "(" + with_digits(point.x, 9) + ", " + with_digits(point.y, 9) + ", " + with_digits(point.z, 9) + ")";
}

std::string info_text(const MeshInfo& info, const CostedLattices& costed, int threads) {
  const MeshStatistics& s = info.statistics;
  InfoTable table;
  table.row("faces", grouped(info.faces));
  if (info.skipped_faces > 0) table.row("skipped faces", grouped(info.skipped_faces) + " of fewer than three corners");
  table.row("vertices", grouped(info.vertices) + ", after welding " + grouped(info.welded_vertices));
  if (!info.unit.empty()) table.row("unit of the file", info.unit);
  if (info.turned) table.row("turned", turned_by(*info.turned));
  table.row("components", grouped(s.components));
  table.row("surface", s.closed() ? "closed" : "open");
  table.row("exterior edges", grouped(s.exterior_edges));
  table.row("inconsistent edges", grouped(s.inconsistent_edges) + " of two faces in the same direction");
  table.row("non-manifold edges", grouped(s.nonmanifold_edges) + " of more than two faces");
  table.row("degenerate faces", grouped(s.degenerate_faces) + " of zero area");
  table.row("duplicate faces",
            grouped(s.duplicate_faces) + ", pairs that cancel " + grouped(info.opposite_duplicate_faces));
  if (info.intersections) table.row("self-intersections", intersections_of(*info.intersections));
  table.row("bounds", printed_point(info.bounds.lower) + " to " + printed_point(info.bounds.upper));
  table.row("size", printed_point(info.bounds.upper - info.bounds.lower) + " world units");
  table.row("area", with_digits(s.surface_area, 9) + " square world units");
  table.row("signed volume", s.signed_volume ? with_digits(*s.signed_volume, 9) + " cubic world units" : "none, open");
  std::string names;
  for (const Warning& warning : info.warnings) names += (names.empty() ? "" : ", ") + warning.name;
  table.row("warnings", names.empty() ? "none" : names);
  const std::string on_threads = counted(static_cast<std::uint64_t>(threads), "thread");
  std::string heading = "cost on " + on_threads;
  for (const CostedLattice& lattice : costed.lattices) {
    table.row(std::exchange(heading, ""), cost_of(lattice, threads));
  }
  if (costed.no_more) table.row("no lattice", *costed.no_more);
  return plain_text(info.mesh, "?") + "\n" + table.text();
}

}  // namespace raycone
