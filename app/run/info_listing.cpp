#include "app/run/info_listing.h"

#include <utility>

#include "app/report/json.h"
#include "app/text/csv.h"

namespace raycone {

std::string InfoListing::entry(const MeshInfo& info, const CostedLattices& costed, int threads) {
  const bool first = !std::exchange(begun_, true);
  switch (layout_.format) {
    case InfoFormat::kText:
      return (first ? "" : "\n") + info_text(info, costed, threads);
    case InfoFormat::kJson:
      return layout_.several ? (first ? "[\n" : ",\n") + to_json_item(info) : to_json(info);
    case InfoFormat::kCsv:
      return (first ? csv_line(csv_names(info)) : "") + csv_line(csv_values(info));
  }
  return "";
}

std::string InfoListing::entry(const VolumeInfo& info) {
  const bool first = !std::exchange(begun_, true);
  if (layout_.format == InfoFormat::kJson)
    return layout_.several ? (first ? "[\n" : ",\n") + to_json_item(info) : to_json(info);
  return (first ? "" : "\n") + info_text(info);
}

std::string InfoListing::end() {
  if (layout_.format == InfoFormat::kText || !layout_.several) return "";
  if (layout_.format == InfoFormat::kJson) return begun_ ? "\n]\n" : "[]\n";
  if (begun_) return "";
  MeshInfo none;  // for its columns
  if (layout_.with_intersections) none.intersections.emplace();
  return csv_line(csv_names(none));
}

}  // namespace raycone
