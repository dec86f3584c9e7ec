// NRRD, teem.sourceforge.net/nrrd/format.html, version 5.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/fields/format_writers.h"
#include "io/fields/image_writer.h"
#include "io/fields/label_colour.h"
#include "io/files/ascii.h"

namespace raycone {
namespace {

std::string vector_text(const Vec3& v) {
  return '(' + shortest_text(v.x) + ',' + shortest_text(v.y) + ',' + shortest_text(v.z) + ')';
}

// Backslashes and line ends are written as NRRD's key/value pairs want them.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\\\";
    } else if (c == '\n') {
      result += "\\n";
    } else {
      result += c;
    }
  }
  return result;
}

// How 3D Slicer knows the segments of a file *.seg.nrrd (its developer guide, "Segmentations"): all in one layer.
std::string segments(const PlacedLattice& lattice, const std::vector<std::string>& labels) {
  std::string extent;
  for (const std::int64_t count : lattice.grid.counts) extent += " 0 " + std::to_string(count - 1);
  std::string text = labels.empty() ? "" : "Segmentation_ContainedRepresentationNames:=Binary labelmap|\n";
  for (std::size_t n = 0; n < labels.size(); ++n) {
    const std::string label = std::to_string(n + 1), segment = "Segment" + std::to_string(n) + '_';
    std::string colour;
    for (const std::uint8_t part : label_colour(n + 1)) {
      colour += (colour.empty() ? "" : " ") + shortest_text(std::round(part / 255.0 * 1e6) / 1e6);
    }
    text += segment + "ID:=Segment_" + label + '\n';
    text += segment + "Name:=" + escaped(labels[n]) + '\n';
    text += segment + "LabelValue:=" + label + '\n';
    text += segment + "Layer:=0\n";
    text += segment + "Extent:=" + extent.substr(1) + '\n';
    text += segment + "Color:=" + colour + '\n';
  }
  return text;
}

std::string nrrd_head(const PlacedLattice& lattice, const OutputDescription& description) {
  static constexpr std::array kTypes{"uint8", "float", "double", "int32"};
  const auto& [i, j, k] = lattice.steps;
  const FieldDescription& field = description.fields.front();
  std::string head =
      "NRRD0005\n# Complete NRRD file format specification at: http://teem.sourceforge.net/nrrd/format.html\n";
  head += std::string("type: ") + kTypes[static_cast<std::size_t>(image_element(description))] + '\n';
  head += "dimension: 3\nspace: right-anterior-superior\nsizes:";
  for (const std::int64_t count : lattice.grid.counts) head += ' ' + std::to_string(count);
  head += "\nspace directions: " + vector_text(i) + ' ' + vector_text(j) + ' ' + vector_text(k) + '\n';
  head += "kinds: domain domain domain\nendian: little\n";
  head += std::string("encoding: ") + (description.compress ? "gzip" : "raw") + '\n';
  head += "space origin: " + vector_text(first_sample(lattice)) + '\n';
  head += "raycone_field:=" + field.name + '\n';
  if (!field.rule.empty()) head += "raycone_rule:=" + field.rule + '\n';
  if (!description.metadata.empty()) head += "raycone:=" + escaped(description.metadata) + '\n';
  head += segments(lattice, description.labels);
  return head + '\n';
}

}  // namespace

std::unique_ptr<LatticeWriter> make_nrrd_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                        const OutputDescription& description) {
  return make_image_writer(output, description, nrrd_head(lattice, description), Packed::kSamples);
}

}  // namespace raycone
