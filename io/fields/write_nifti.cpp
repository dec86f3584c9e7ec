// NIfTI-1, the header nifti1.h of nifti.nimh.nih.gov.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "core/data/coordinate_precision.h"
#include "io/fields/format_writers.h"
#include "io/fields/image_writer.h"
#include "io/fields/nifti_fields.h"
#include "io/fields/quaternion.h"
#include "io/files/ascii.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

constexpr std::int16_t kScannerSpace = 1;

// The head, and four bytes that say that no extension follows.
class NiftiHeadBytes {
 public:
  NiftiHeadBytes() : bytes_(nifti::kHeadSize + 4, '\0') {}

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

Vec3 in_32_bits(const Vec3& v) { return rounded_to(CoordinatePrecision::kSingle, v); }

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
    throw OutputError(name + ": the 32 bits of NIfTI-1 would displace samples by " + with_digits(displaced, 2) +
                      " voxels, so far from the origin; see --normalize, or take NRRD");
  }
}

// The place of the voxels as a rotation, which programs read that know no matrices; nothing where it is none, nor where
// what they decode would displace samples: near half turns the parts of a quaternion leave no real part.
void put_rotation(NiftiHeadBytes& head, const PlacedLattice& lattice) {
  constexpr double kRounding = 1e-5;  // of matrices in 32 bits, which some programs also compute in these
  std::array<Vec3, 3> columns = lattice.units();
  const bool mirrored = dot(columns[0], cross(columns[1], columns[2])) < 0.0;
  head.put<float>(nifti::kPixDim, mirrored ? -1.0F : 1.0F);
  if (!lattice.is_orthogonal(kRounding)) return;
  if (mirrored) columns[2] = -1.0 * columns[2];
  const std::array<float, 3> parts = stored_parts(quaternion_of(columns));
  const auto& [b, c, d] = parts;
  std::array<Vec3, 3> decoded = columns_of({static_cast<double>(b), static_cast<double>(c), static_cast<double>(d)});
  if (mirrored) decoded[2] = -1.0 * decoded[2];
  for (std::size_t n = 0; n < 3; ++n) {
    decoded[n] = in_32_bits(lattice.grid.spacing)[static_cast<int>(n)] * decoded[n];
  }
  const Vec3 first = first_sample(lattice);
  if (displacement(lattice, in_32_bits(first), decoded) > kMostDisplaced) return;
  head.put(nifti::kQFormCode, kScannerSpace);
  for (std::size_t a = 0; a < 3; ++a) {
    head.put(nifti::kQuatern + 4 * a, parts[a]);
    head.put(nifti::kQOffset + 4 * a, static_cast<float>(first[static_cast<int>(a)]));
  }
}

std::string nifti_head_bytes(const PlacedLattice& lattice, const OutputDescription& description) {
  static constexpr std::array<std::pair<int, int>, 4> kTypes{{{2, 8}, {16, 32}, {64, 64}, {8, 32}}};  // code, bits
  const auto [code, bits] = kTypes[static_cast<std::size_t>(image_element(description))];
  const Vec3 first = first_sample(lattice);
  NiftiHeadBytes head;
  head.put<std::int32_t>(nifti::kSizeOfHead, nifti::kHeadSize);
  head.put<std::int16_t>(nifti::kDim, 3);
  for (std::size_t n = 1; n < 8; ++n) {
    head.put<std::int16_t>(nifti::kDim + 2 * n, static_cast<std::int16_t>(n <= 3 ? lattice.grid.counts[n - 1] : 1));
  }
  head.put<std::int16_t>(nifti::kDataType, static_cast<std::int16_t>(code));
  head.put<std::int16_t>(nifti::kBitPix, static_cast<std::int16_t>(bits));
  head.put<float>(nifti::kVoxOffset, nifti::kHeadSize + 4);
  head.put<float>(nifti::kSclSlope, 1.0F);  // values are as stored
  head.put_text(nifti::kDescrip, nifti::kDescripRoom,
                std::string("raycone ") + RAYCONE_VERSION + ' ' + description.fields.front().name);
  head.put(nifti::kSFormCode, kScannerSpace);
  put_rotation(head, lattice);
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    head.put(nifti::kPixDim + 4 * (a + 1), static_cast<float>(lattice.grid.spacing[axis]));
    const std::size_t row = nifti::kSRow + nifti::kRowSize * a;
    for (std::size_t n = 0; n < 3; ++n) head.put(row + 4 * n, static_cast<float>(lattice.steps[n][axis]));
    head.put(row + 12, static_cast<float>(first[axis]));
  }
  head.put_text(nifti::kMagic, 4, "n+1");
  return head.bytes();
}

}  // namespace

std::unique_ptr<LatticeWriter> make_nifti_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                         const OutputDescription& description) {
  check_nifti(lattice, output.name());
  return make_image_writer(output, description, nifti_head_bytes(lattice, description), Packed::kFile);
}

}  // namespace raycone
