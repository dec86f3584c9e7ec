#include "app/report/volume_info.h"

#include <array>
#include <utility>

#include "app/report/info.h"
#include "app/report/json.h"
#include "app/text/plain_text.h"

namespace raycone {
namespace {

// "inside |b1 (64, 41, 32)"
std::string described(const ArrayFacts& array) {
  std::string text = array.name;
  text += (text.empty() || array.type.empty() ? "" : " ") + array.type;
  if (array.shape.empty()) return text;
  std::string sizes;
  for (const std::uint64_t size : array.shape) sizes += (sizes.empty() ? "" : ", ") + std::to_string(size);
  return text + " (" + sizes + ")";
}

std::string indices_text(const std::array<std::int64_t, 3>& n) {
  return "(" + std::to_string(n[0]) + ", " + std::to_string(n[1]) + ", " + std::to_string(n[2]) + ")";
}

void add_rows(InfoTable& table, const PlacedLattice& lattice) {
  const Lattice& grid = lattice.grid;
  const auto [nx, ny, nz] = grid.counts;
  const auto [i, j, k] = grid.index_min;
  table.row("samples", std::to_string(nx) + " x " + std::to_string(ny) + " x " + std::to_string(nz));
  table.row("indices", indices_text(grid.index_min) + " to " +
                           indices_text({grid.index_max(0), grid.index_max(1), grid.index_max(2)}));
  table.row("first sample", printed_point(lattice.position(i, j, k)));
  table.row("last sample", printed_point(lattice.position(grid.index_max(0), grid.index_max(1), grid.index_max(2))));
  table.row("spacing", printed_point(grid.spacing) + " world units");
  if (lattice.along_axes()) return table.row("axes", "those of the world");
  std::string heading = "axes";
  for (const Vec3& axis : lattice.units())
    table.row(std::exchange(heading, ""), printed_point(axis + Vec3{}));  // no -0
}

}  // namespace

std::string info_text(const VolumeInfo& info) {
  const VolumeFacts& facts = info.facts;
  InfoTable table;
  table.row("format", facts.format);
  std::string heading = facts.format == "OpenVDB" ? "grids" : "arrays";
  for (const ArrayFacts& array : facts.arrays) {
    table.row(std::exchange(heading, ""), plain_text(described(array), "?"));
  }
  if (facts.lattice) add_rows(table, *facts.lattice);
  if (!facts.no_lattice.empty()) table.row("no lattice", plain_text(facts.no_lattice, "?"));
  for (const auto& [key, value] : made_lines(facts)) table.row(plain_text(key, "?"), plain_text(value, "?"));
  return plain_text(info.file, "?") + "\n" + table.text();
}

}  // namespace raycone
