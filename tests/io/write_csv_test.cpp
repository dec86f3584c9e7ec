#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "io/fields/field_writer.h"
#include "tests/support/output_checks.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"

namespace raycone {
namespace {

using test::read_text;
using test::TemporaryDirectory;

std::string points_csv(const std::vector<Vec3>& points, const std::vector<double>& values) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.csv");
  const auto writer = make_point_writer(FieldFormat::kCsv, output, std::nullopt, {});
  const FieldValues field = std::span(values);
  writer->write(points, {&field, 1});
  writer->finish();
  return read_text(directory / "out.csv");
}

std::string lattice_csv(const Lattice& lattice, const std::vector<double>& values, const std::string& column) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.csv");
  OutputDescription description;
  description.fields.front().column = column;
  test::write_in_slabs(FieldFormat::kCsv, output, lattice, description, values, 1);
  return read_text(directory / "out.csv");
}

TEST(WriteCsv, PrintsPointsInOrderAsShortestText) {
  EXPECT_EQ(points_csv({{0.1, -2, 1e300}, {0, 5e-324, 0.5}}, {0.30000000000000004, 1}),
            "x,y,z,w\n"
            "0.1,-2,1e+300,0.30000000000000004\n"
            "0,5e-324,0.5,1\n");
}

TEST(WriteCsv, PrintsNegativeZeroAsZero) { EXPECT_EQ(points_csv({{-0.0, -0.0, -0.0}}, {-0.0}), "x,y,z,w\n0,0,0,0\n"); }

TEST(WriteCsv, HasAHeaderWithoutPoints) { EXPECT_EQ(points_csv({}, {}), "x,y,z,w\n"); }

TEST(WriteCsv, RoundTripsEveryBit) {
  std::mt19937_64 random(1);
  std::vector<Vec3> points;
  std::vector<double> values;
  const auto finite = [&] {
    double value;
    do {
      value = std::bit_cast<double>(random());
    } while (!(std::abs(value) <= std::numeric_limits<double>::max()));
    return value;
  };
  for (int n = 0; n < 5000; ++n) {
    points.push_back({finite(), finite(), finite()});
    values.push_back(finite());
  }
  points.push_back({-2.2250738585072014e-308, -2.2250738585072014e-308, -2.2250738585072014e-308});  // the longest
  values.push_back(-2.2250738585072014e-308);

  std::istringstream text(points_csv(points, values));
  std::string line;
  std::getline(text, line);
  for (std::size_t n = 0; n < points.size(); ++n) {
    ASSERT_TRUE(std::getline(text, line));
    const char* at = line.c_str();
    for (const double expected : {points[n].x, points[n].y, points[n].z, values[n]}) {
      char* end = nullptr;
      ASSERT_EQ(std::bit_cast<std::uint64_t>(std::strtod(at, &end)), std::bit_cast<std::uint64_t>(expected)) << line;
      at = end + 1;
    }
  }
  EXPECT_FALSE(std::getline(text, line));
}

TEST(WriteCsv, PrintsLatticesWithIFastest) {
  Lattice lattice;
  lattice.origin = {0.5, 0, -1};
  lattice.spacing = {0.1, 1, 2};
  lattice.index_min = {-1, 3, 7};
  lattice.counts = {2, 2, 2};
  EXPECT_EQ(lattice_csv(lattice, {0, 1, 2, 3, 4, 5, 6, 0.25}, "w"),
            "i,j,k,x,y,z,w\n"
            "-1,3,7,0.4,3,13,0\n"
            "0,3,7,0.5,3,13,1\n"
            "-1,4,7,0.4,4,13,2\n"
            "0,4,7,0.5,4,13,3\n"
            "-1,3,8,0.4,3,15,4\n"
            "0,3,8,0.5,3,15,5\n"
            "-1,4,8,0.4,4,15,6\n"
            "0,4,8,0.5,4,15,0.25\n");
}

TEST(WriteCsv, NamesTheColumnAfterTheField) {
  EXPECT_EQ(lattice_csv({{}, {1, 1, 1}, {}, {1, 1, 1}}, {1}, "inside"), "i,j,k,x,y,z,inside\n0,0,0,0,0,0,1\n");
}

TEST(WriteCsv, HasAColumnPerFieldInTheirOrder) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.csv");
  OutputDescription description;
  description.fields = {{"inside", "inside", "inside", FieldKind::kFlag, 0.0, "odd"}, {}};
  const auto writer = make_point_writer(FieldFormat::kCsv, output, std::nullopt, description);
  const std::vector<std::uint8_t> inside{1, 0};
  const std::vector<double> w{1, 0.25};
  writer->write(std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}, std::vector<FieldValues>{std::span(inside), std::span(w)});
  writer->finish();
  EXPECT_EQ(read_text(directory / "out.csv"), "x,y,z,inside,w\n1,2,3,1,1\n4,5,6,0,0.25\n");
}

TEST(WriteCsv, HasRoomForTheLongestRows) {
  Lattice lattice;
  const double longest = -2.2250738585072014e-308;
  lattice.origin = {longest, longest, longest};
  lattice.spacing = {5e-324, 5e-324, 5e-324};
  lattice.index_min = {-1000000, -1000000, -1000000};
  lattice.counts = {3000, 1, 1};
  const std::string text = lattice_csv(lattice, std::vector<double>(3000, longest), "w");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3001);
  EXPECT_TRUE(text.ends_with(",-2.2250738585072014e-308\n"));
}

TEST(WriteCsv, PrintsDiagnosticsBehindTheValuesOfPoints) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.csv");
  const auto writer = make_point_writer(FieldFormat::kCsv, output, std::nullopt, test::described_with_diagnostics());
  const std::vector<double> values{0.5, -1};
  writer->write(std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}, test::FourDiagnostics().from(0, values));
  writer->finish();
  EXPECT_EQ(read_text(directory / "out.csv"),
            "x,y,z,w,crossings,degenerate,on_surface,error_bound\n"
            "1,2,3,0.5,0,0,0,5e-324\n"
            "4,5,6,-1,-3,2,1,0.1\n");
}

TEST(WriteCsv, PrintsDiagnosticsOfLatticesSampleBySample) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.csv");
  const Lattice lattice{{}, {1, 1, 1}, {}, {2, 1, 2}};
  const auto writer = make_lattice_writer(FieldFormat::kCsv, output, lattice, test::described_with_diagnostics());
  const test::FourDiagnostics diagnostics;
  const std::vector<double> lower{1, 2}, upper{3, 4};
  writer->write({{0, 0, 0}, {2, 1, 1}}, diagnostics.from(0, lower));
  writer->write({{0, 0, 1}, {2, 1, 1}}, diagnostics.from(2, upper));
  writer->finish({});
  EXPECT_EQ(read_text(directory / "out.csv"),
            "i,j,k,x,y,z,w,crossings,degenerate,on_surface,error_bound\n"
            "0,0,0,0,0,0,1,0,0,0,5e-324\n"
            "1,0,0,1,0,0,2,-3,2,1,0.1\n"
            "0,0,1,0,0,1,3,9007199254740993,1,0,0\n"
            "1,0,1,1,0,1,4,1,0,0,1e-16\n");
}

TEST(WriteCsv, HasRoomForTheLongestRowsWithDiagnostics) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.csv");
  const auto writer = make_point_writer(FieldFormat::kCsv, output, std::nullopt, test::described_with_diagnostics());
  const double longest = -2.2250738585072014e-308;
  std::vector<std::int64_t> counts(3000, std::numeric_limits<std::int64_t>::min());
  std::vector<std::uint8_t> flags(3000, 1);
  std::vector<double> values(3000, longest), bounds(3000, -longest);
  writer->write(std::vector<Vec3>(3000, {longest, longest, longest}),
                std::vector<FieldValues>{std::span<const double>(values), std::span<const std::int64_t>(counts),
                                         std::span<const std::int64_t>(counts), std::span<const std::uint8_t>(flags),
                                         std::span<const double>(bounds)});
  writer->finish();
  const std::string text = read_text(directory / "out.csv");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3001);
  EXPECT_TRUE(text.ends_with(",-9223372036854775808,-9223372036854775808,1,2.2250738585072014e-308\n"));
}

TEST(WriteCsv, FlushHandsRowsToTheSystem) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  {
    OutputFile output("/dev/fd/" + std::to_string(ends[1]));
    const auto writer = make_point_writer(FieldFormat::kCsv, output, std::nullopt, {});
    const std::vector<double> values{4};
    const FieldValues field = std::span(values);
    writer->write(std::vector<Vec3>{{1, 2, 3}}, {&field, 1});
    writer->flush();
    char text[64] = {};
    EXPECT_GT(read(ends[0], text, sizeof text - 1), 0);
    EXPECT_STREQ(text, "x,y,z,w\n1,2,3,4\n");
    writer->finish();
  }
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace raycone
