// Volumes of medical imaging: NRRD (teem.sourceforge.net/nrrd/format.html, version 5) and NIfTI-1 (the header nifti1.h
// of nifti.nimh.nih.gov). Both are a head and the samples, x fastest, and place the middles of voxels: here the
// samples, in the mesh's own coordinates, which viewers take for right, anterior, superior. Written here because a head
// is all there is to write: libnifti would want the whole volume in memory.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "io/fields/array_elements.h"
#include "io/fields/format_writers.h"
#include "io/fields/label_colour.h"
#include "io/fields/quaternion.h"
#include "io/files/ascii.h"
#include "io/files/file_error.h"
#include "io/files/gzip_writer.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as they are in memory");

enum class Element { kByte, kFloat, kDouble, kInteger };

Element element_of(const OutputDescription& description) {
  if (description.fields.front().kind == FieldKind::kFlag) return Element::kByte;
  if (description.fields.front().kind == FieldKind::kLabel) return Element::kInteger;
  return description.is(Precision::kDouble) ? Element::kDouble : Element::kFloat;
}

Vec3 first_sample(const PlacedLattice& lattice) {
  const auto [i, j, k] = lattice.grid.index_min;
  return lattice.position(i, j, k);
}

// --- NRRD -----------------------------------------------------------------------------------------------------------

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
  head += std::string("type: ") + kTypes[static_cast<std::size_t>(element_of(description))] + '\n';
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

// --- NIfTI-1 --------------------------------------------------------------------------------------------------------

constexpr std::int16_t kScannerSpace = 1;

// The 348 bytes of the head, and four that say that no extension follows.
class NiftiHead {
 public:
  NiftiHead() : bytes_(352, '\0') {}

  template <typename Number>
  void put(std::size_t offset, Number number) {
    std::memcpy(&bytes_[offset], &number, sizeof number);
  }
  void put_text(std::size_t offset, std::size_t room, const std::string& text) {
    bytes_.replace(offset, std::min(room - 1, text.size()), text.substr(0, room - 1));
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Whether it is finite in 32 bits.
bool fits_float(const Vec3& v) {
  const auto fits = [](double number) { return std::isfinite(static_cast<float>(number)); };
  return fits(v.x) && fits(v.y) && fits(v.z);
}

constexpr double kMostDisplaced = 0.0625;  // voxels: less than anybody sees

double in_32_bits(double number) { return static_cast<double>(static_cast<float>(number)); }
Vec3 in_32_bits(const Vec3& v) { return {in_32_bits(v.x), in_32_bits(v.y), in_32_bits(v.z)}; }

// How far a sample is displaced at most, in voxels, where the first one and the steps are these.
double displacement(const PlacedLattice& lattice, const Vec3& first, const std::array<Vec3, 3>& steps) {
  double most = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    double sum = std::abs(first[axis] - first_sample(lattice)[axis]);
    for (std::size_t n = 0; n < 3; ++n) {
      sum += static_cast<double>(lattice.grid.counts[n] - 1) * std::abs(steps[n][axis] - lattice.steps[n][axis]);
    }
    most = std::max(most, sum / lattice.grid.least_spacing());
  }
  return most;
}

// By the sform.
double nifti_displacement(const PlacedLattice& lattice) {
  const auto& [i, j, k] = lattice.steps;
  return displacement(lattice, in_32_bits(first_sample(lattice)), {in_32_bits(i), in_32_bits(j), in_32_bits(k)});
}

void check_nifti(const PlacedLattice& lattice, const std::string& name) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int16_t>::max();
  for (const std::int64_t count : lattice.grid.counts) {
    if (count <= kMost) continue;
    throw OutputError(name + ": " + std::to_string(count) +
                      " samples along an axis do not fit in the 16 bits of NIfTI-1");
  }
  const Vec3& spacing = lattice.grid.spacing;
  const auto least = static_cast<float>(lattice.grid.least_spacing());
  if (!fits_float(spacing) || !fits_float(first_sample(lattice)) || least < std::numeric_limits<float>::min()) {
    throw OutputError(name + ": spacing and place do not fit in the 32 bits of NIfTI-1; see --scale");
  }
  if (const double displaced = nifti_displacement(lattice); displaced > kMostDisplaced) {
    std::array<char, 16> text;
    std::snprintf(text.data(), text.size(), "%.2g", displaced);
    throw OutputError(name + ": the 32 bits of NIfTI-1 would displace samples by " + text.data() +
                      " voxels, so far from the origin; see --normalize, or take NRRD");
  }
}

// The place of the voxels as a rotation, which programs read that know no matrices; nothing where it is none, nor where
// what they decode would displace samples: near half turns the parts of a quaternion leave no real part.
void put_rotation(NiftiHead& head, const PlacedLattice& lattice) {
  constexpr double kRounding = 1e-5;  // of matrices in 32 bits, which some programs also compute in these
  std::array<Vec3, 3> columns = lattice.units();
  const bool mirrored = dot(columns[0], cross(columns[1], columns[2])) < 0.0;
  head.put<float>(76, mirrored ? -1.0F : 1.0F);
  if (!lattice.is_orthogonal(kRounding)) return;
  if (mirrored) columns[2] = -1.0 * columns[2];
  const std::array<float, 3> parts = stored_parts(quaternion_of(columns));
  const auto& [b, c, d] = parts;
  std::array<Vec3, 3> decoded = columns_of({static_cast<double>(b), static_cast<double>(c), static_cast<double>(d)});
  if (mirrored) decoded[2] = -1.0 * decoded[2];
  for (std::size_t n = 0; n < 3; ++n) {
    decoded[n] = in_32_bits(lattice.grid.spacing[static_cast<int>(n)]) * decoded[n];
  }
  const Vec3 first = first_sample(lattice);
  if (displacement(lattice, in_32_bits(first), decoded) > kMostDisplaced) return;
  head.put(252, kScannerSpace);
  for (std::size_t a = 0; a < 3; ++a) {
    head.put(256 + 4 * a, parts[a]);
    head.put(268 + 4 * a, static_cast<float>(first[static_cast<int>(a)]));
  }
}

std::string nifti_head(const PlacedLattice& lattice, const OutputDescription& description) {
  // Offsets are those of nifti1.h.
  static constexpr std::array<std::pair<int, int>, 4> kTypes{{{2, 8}, {16, 32}, {64, 64}, {8, 32}}};  // code, bits
  const auto [code, bits] = kTypes[static_cast<std::size_t>(element_of(description))];
  const Vec3 first = first_sample(lattice);
  NiftiHead head;
  head.put<std::int32_t>(0, 348);
  head.put<std::int16_t>(40, 3);
  for (std::size_t n = 1; n < 8; ++n) {
    head.put<std::int16_t>(40 + 2 * n, static_cast<std::int16_t>(n <= 3 ? lattice.grid.counts[n - 1] : 1));
  }
  head.put<std::int16_t>(70, static_cast<std::int16_t>(code));
  head.put<std::int16_t>(72, static_cast<std::int16_t>(bits));
  head.put<float>(108, 352.0F);
  head.put<float>(112, 1.0F);  // values are as stored
  head.put_text(148, 80, std::string("raycone ") + RAYCONE_VERSION + ' ' + description.fields.front().name);
  head.put(254, kScannerSpace);
  put_rotation(head, lattice);
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    head.put(80 + 4 * a, static_cast<float>(lattice.grid.spacing[axis]));
    for (std::size_t n = 0; n < 3; ++n) head.put(280 + 16 * a + 4 * n, static_cast<float>(lattice.steps[n][axis]));
    head.put(280 + 16 * a + 12, static_cast<float>(first[axis]));
  }
  head.put_text(344, 4, "n+1");
  return head.bytes();
}

// --- Either ---------------------------------------------------------------------------------------------------------

class ImageWriter final : public LatticeWriter {
 public:
  // `packs_head`: the whole file is compressed, not just what follows the head.
  ImageWriter(OutputFile& output, const OutputDescription& description, const std::string& head, bool packs_head)
      : output_(output),
        elements_(make_array_elements(description.fields.front(), description.precision.value_or(Precision::kSingle),
                                      output.name())) {
    if (!packs_head) output_.write(head.data(), head.size());
    if (description.compress) packed_.emplace(output_);
    if (packs_head) append({head.data(), head.size()});
  }

  int slab_axis() const override { return 2; }
  std::int64_t slab_alignment() const override { return 1; }
  void write(const LatticeBlock&, std::span<const FieldValues> fields) override {
    append(elements_->in_order(fields.front()));
  }
  void finish(const FieldTotals&) override {
    if (packed_) packed_->finish();
    output_.commit();
  }

 private:
  void append(std::span<const char> bytes) {
    if (packed_) return packed_->write(bytes.data(), bytes.size());
    output_.write(bytes.data(), bytes.size());
  }

  OutputFile& output_;
  std::unique_ptr<ArrayElements> elements_;
  std::optional<GzipWriter> packed_;
};

void check_fields(const OutputDescription& description) {
  if (description.components() != 1) throw std::logic_error("an image holds one number per sample");
}

}  // namespace

std::unique_ptr<LatticeWriter> make_nrrd_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                        const OutputDescription& description) {
  check_fields(description);
  return std::make_unique<ImageWriter>(output, description, nrrd_head(lattice, description), false);
}

std::unique_ptr<LatticeWriter> make_nifti_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                         const OutputDescription& description) {
  check_fields(description);
  check_nifti(lattice, output.name());
  return std::make_unique<ImageWriter>(output, description, nifti_head(lattice, description), description.compress);
}

}  // namespace raycone
