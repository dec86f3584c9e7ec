// Room that is asked for before the work: no more than files take, which would refuse good runs, and of binary ones
// hardly less.
#include "app/samples/disk_space.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/files/output_file.h"
#include "tests/support/temporary_directory.h"

namespace raycone {
namespace {

using test::TemporaryDirectory;

constexpr std::int64_t kSamplesAlong = 20;
constexpr std::size_t kSamples = kSamplesAlong * kSamplesAlong * kSamplesAlong;
constexpr double kBytesOfHeads = 4096.0;  // of a file and its arrays, and what archives say about them

// As many zeros as a file may be asked to hold, of any kind.
class Zeros {
 public:
  [[nodiscard]] std::vector<FieldValues> of(const OutputDescription& description) const {
    std::vector<FieldValues> values;
    for (const FieldDescription& field : description.fields) values.push_back(of(field.kind));
    return values;
  }

 private:
  [[nodiscard]] FieldValues of(FieldKind kind) const {
    switch (kind) {
      case FieldKind::kVector:
        return std::span(vectors_);
      case FieldKind::kCount:
        return std::span(counts_);
      case FieldKind::kFlag:
        return std::span(flags_);
      case FieldKind::kLabel:
        return std::span(labels_);
      default:
        return std::span(reals_);
    }
  }

  std::vector<double> reals_ = std::vector<double>(kSamples);
  std::vector<Vec3> vectors_ = std::vector<Vec3>(kSamples);
  std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(kSamples);
  std::vector<std::uint8_t> flags_ = std::vector<std::uint8_t>(kSamples);
  std::vector<std::int32_t> labels_ = std::vector<std::int32_t>(kSamples);
};

OutputDescription described(const std::vector<FieldKind>& kinds, std::optional<Precision> precision) {
  OutputDescription description;
  description.fields.clear();
  for (const FieldKind kind : kinds) {
    const std::string n = std::to_string(description.fields.size());
    const std::string column = kind == FieldKind::kVector ? "x" + n + ",y" + n + ",z" + n : "c" + n;
    const std::string name = kind == FieldKind::kFlag ? "inside" : "f" + n;
    description.fields.push_back({name, column, "g" + n, kind, 0.0, ""});
  }
  description.precision = precision;
  return description;
}

class DiskSpace : public testing::Test {
 protected:
  void expect_enough(std::uint64_t asked, bool is_binary, const std::string& what) const {
    const auto size = static_cast<double>(std::filesystem::file_size(path_));
    EXPECT_LE(static_cast<double>(asked), size) << what;
    EXPECT_GT(asked, kSamples / 8 - 1) << what;
    if (is_binary) {
      EXPECT_GE(static_cast<double>(asked) + kBytesOfHeads, size) << what;
    }
  }

  void expect_enough_of_lattice(FieldFormat format, const OutputDescription& description, const std::string& what) {
    Lattice lattice;
    lattice.spacing = {1, 1, 1};
    lattice.counts = {kSamplesAlong, kSamplesAlong, kSamplesAlong};
    {
      OutputFile output(path_);
      const auto writer = make_lattice_writer(format, output, lattice, description);
      writer->write(whole(lattice), zeros_.of(description));
      writer->finish({});
    }
    expect_enough(least_lattice_file(format, description, kSamples), format != FieldFormat::kCsv, what);
  }

  void expect_enough_of_points(FieldFormat format, const OutputDescription& description, const std::string& what) {
    const std::vector<Vec3> points(kSamples);
    {
      OutputFile output(path_);
      const auto writer = make_point_writer(format, output, kSamples, description);
      writer->write(points, zeros_.of(description));
      if (description.has_places) writer->write_places(points, std::vector<std::int64_t>(kSamples));
      writer->finish();
    }
    expect_enough(least_point_file(format, description, kSamples), format != FieldFormat::kCsv, what);
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_ / "file";
  Zeros zeros_;
};

const std::vector<std::optional<Precision>> kAllPrecisions{std::nullopt, Precision::kHalf, Precision::kSingle,
                                                           Precision::kDouble};
const std::vector<FieldKind> kAllKinds{FieldKind::kReal,  FieldKind::kDensity, FieldKind::kDistance, FieldKind::kVector,
                                       FieldKind::kBound, FieldKind::kCount,   FieldKind::kFlag,     FieldKind::kLabel};

TEST_F(DiskSpace, IsWhatLatticesTake) {
  for (const FieldFormat format : formats_that_hold(FormatTraits::kLattices)) {
    const FormatTraits& traits = traits_of(format);
    if (traits.storage == NumberStorage::kGrids) continue;  // where all is zero, they hold nothing
    for (const std::optional<Precision> precision : kAllPrecisions) {
      if (precision == Precision::kHalf && !traits.holds(FormatTraits::kHalves)) continue;
      for (const FieldKind kind : kAllKinds) {
        if (kind == FieldKind::kVector && !traits.holds(FormatTraits::kVectors)) continue;
        OutputDescription description = described({kind}, precision);
        description.packs_flags = format == FieldFormat::kNpz;  // others are never asked to
        expect_enough_of_lattice(
            format, description,
            std::to_string(static_cast<int>(format)) + " " + std::to_string(static_cast<int>(kind)));
      }
      if (traits.holds(FormatTraits::kSeveralFields)) {
        expect_enough_of_lattice(format, described(kAllKinds, precision), "all kinds");
      }
    }
  }
}

// Zeros, which these are, would be refused for want of room that they do not need.
TEST_F(DiskSpace, IsNothingOfCompressedLattices) {
  OutputDescription description = described({FieldKind::kReal}, std::nullopt);
  description.compress = true;
  for (const FieldFormat format : {FieldFormat::kNrrd, FieldFormat::kNiftiGz}) {
    EXPECT_EQ(least_lattice_file(format, description, kSamples), 0U);
  }
}

TEST_F(DiskSpace, IsWhatPointsTake) {
  for (const FieldFormat format :
       {FieldFormat::kCsv, FieldFormat::kNpy, FieldFormat::kNpz, FieldFormat::kRawDouble, FieldFormat::kRawSingle}) {
    for (const std::optional<Precision> precision : kAllPrecisions) {
      for (const FieldKind kind : kAllKinds) {
        OutputDescription description = described({kind}, precision);
        expect_enough_of_points(format, description, "points " + std::to_string(static_cast<int>(kind)));
        if (format != FieldFormat::kNpz) continue;
        description.has_places = true;
        expect_enough_of_points(format, description, "with places");
        description.single_points = true;
        expect_enough_of_points(format, description, "with places in 32 bits");
      }
      expect_enough_of_points(format, described(kAllKinds, precision), "all kinds");
    }
  }
}

}  // namespace
}  // namespace raycone
