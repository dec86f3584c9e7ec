#include "app/run/labelled_parts.h"

#include <algorithm>
#include <string>
#include <utility>

#include "app/input/mesh_warnings.h"
#include "app/process/stopwatch.h"

namespace raycone {
namespace {

// The first few, joined.
std::string listed_names(const std::vector<std::size_t>& empty, const MeshParts& parts) {
  constexpr std::size_t kMost = 3;
  std::string text;
  for (std::size_t n = 0; n < std::min(empty.size(), kMost); ++n) text += (n > 0 ? ", " : "") + parts.name(empty[n]);
  return text + (empty.size() > kMost ? ", ..." : "");
}

// Of a part: one of negative volume counts as a component, if none of its own is reversed.
std::uint64_t reversed_components(const MeshDefects& defects) {
  return defects.reversed_components == 0 && defects.negative_volume ? 1 : defects.reversed_components;
}

}  // namespace

LabelledParts::LabelledParts(MeshRun& run, const MeshOptions& mesh, const FieldOptions& field,
                             const std::vector<WrittenFile>& written, WholeMesh whole)
    : run_(run),
      mesh_(mesh),
      field_(field),
      whole_(whole),
      parts_(timed(run.report.seconds.read, [&] { return MeshParts(mesh, run.limits(), whole); })) {
  RunReport& report = run.report;
  report.transform = parts_.transform();
  for (const MeshParts::File& file : parts_.files()) {
    report.meshes.push_back(file.read);
    report.files_read.push_back(file.read.path);
    for (const FileRead& companion : file.companions) report.files_read.push_back(companion.path);
    report.companions.insert(report.companions.end(), file.companions.begin(), file.companions.end());
    report.vertices += file.vertices;
    report.faces += file.faces;
  }
  report.files_read.insert(report.files_read.end(), mesh.lists.begin(), mesh.lists.end());
  report.sha256 = report.meshes.front().sha256;
  report.unit = parts_.files().front().unit;
  run.check_files_read(written);
  for (const MeshParts::File& file : parts_.files()) run.warn_about(file.read.path, file.warnings);
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    report.parts.push_back({parts_.name(n), parts_.files()[parts_.file_of(n)].read.path});
  }
}

MeshToEvaluate LabelledParts::next() {
  TriangleMesh welded = timed(run_.report.seconds.read, [&] { return parts_.part(next_, warnings_); });
  MeshToEvaluate part = timed(run_.report.seconds.prepare, [&] { return oriented_mesh(std::move(welded), mesh_); });
  note(part);
  ++next_;
  if (next_ == size() || parts_.file_of(next_) != parts_.file_of(next_ - 1)) warn_about_file();
  return part;
}

// A cavity is reversed as a part of its own, which is no harm where the rule does not care.
void LabelledParts::note(const MeshToEvaluate& part) {
  PartReport& report = run_.report.parts[next_];
  report.faces = part.mesh.triangles.size();
  report.exterior_edges = part.edges.size();
  defects_.inconsistent_edges += part.defects.inconsistent_edges;
  defects_.cancelling_pairs += part.defects.cancelling_pairs;
  if (!ignores_orientation(field_.rule)) defects_.reversed_components += reversed_components(part.defects);
  turned_ += part.orientation;
  if (whole_ != WholeMesh::kEvaluated) run_.report.orientation += part.orientation;
}

// Where the meshes are one mesh, too, the warnings are about that.
void LabelledParts::warn_about_file() {
  std::ranges::move(warnings_about(turned_), std::back_inserter(warnings_));
  std::ranges::move(warnings_about(defects_, mesh_.orient), std::back_inserter(warnings_));
  if (whole_ != WholeMesh::kEvaluated) run_.warn_about(parts_.files()[parts_.file_of(next_ - 1)].read.path, warnings_);
  warnings_.clear();
  defects_ = {};
  turned_ = {};
}

void LabelledParts::note_empty() {
  const bool is_slice = whole_ == WholeMesh::kShown;  // which may miss any part
  if (!is_slice) empty_.push_back(next_ - 1);
}

void LabelledParts::spent(const FieldEvaluator& evaluator) { terms_ += evaluator.winding_number().terms(); }

// About the file of the first of them.
void LabelledParts::warn_of_empty_parts() {
  const std::string parts = empty_.size() == 1 ? "1 part has" : std::to_string(empty_.size()) + " parts have";
  const std::string text = parts + " no sample inside by the rule " + name_of(field_.rule) + " (" +
                           listed_names(empty_, parts_) + "); a finer lattice helps where parts are thin" +
                           (mesh_.orient == Orient::kAuto ? "" : ", --orient auto where faces are reversed");
  run_.warn_about(parts_.files()[parts_.file_of(empty_.front())].read.path, {{"empty", text}});
}

void LabelledParts::finish(std::span<const std::uint64_t> samples) {
  RunReport& report = run_.report;
  for (std::size_t n = 0; n < size(); ++n) report.parts[n].samples = samples[n + 1];
  if (!empty_.empty()) warn_of_empty_parts();
  report.terms += terms_;
  if (!field_.labels_only()) return;
  report.tally += tally_;
  report.exterior_edges = 0;
  for (const PartReport& part : report.parts) report.exterior_edges += part.exterior_edges;
}

}  // namespace raycone
