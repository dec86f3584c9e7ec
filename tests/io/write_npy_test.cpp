#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "io/fields/field_writer.h"
#include "tests/support/output_checks.h"
#include "tests/support/pipe.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"

namespace raycone {
namespace {

using test::read_text;
using test::TemporaryDirectory;

std::string header_text(const std::string& npy) { return npy.substr(10, npy.find('\n') - 10); }

std::size_t header_size(const std::string& npy) { return npy.find('\n') + 1; }

template <typename Element>
std::vector<Element> elements(const std::string& npy) {
  const std::string body = npy.substr(header_size(npy));
  std::vector<Element> result(body.size() / sizeof(Element));
  std::memcpy(result.data(), body.data(), result.size() * sizeof(Element));
  return result;
}

std::vector<double> random_values(std::size_t count) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> values(count);
  for (double& value : values) value = normal(random);
  return values;
}

Lattice lattice_of(std::int64_t nx, std::int64_t ny, std::int64_t nz) {
  return {{0, 0, 0}, {1, 1, 1}, {-3, 5, -7}, {nx, ny, nz}};
}

std::string lattice_npy(const Lattice& lattice, const std::vector<double>& values, bool double_precision,
                        std::int64_t thickness) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.npy");
  OutputDescription description;
  if (double_precision) description.precision = Precision::kDouble;
  test::write_in_slabs(FieldFormat::kNpy, output, lattice, description, values, thickness);
  return read_text(directory / "out.npy");
}

TEST(WriteNpy, HeaderIsVersion1PaddedTo64Bytes) {
  const std::string npy = lattice_npy(lattice_of(2, 3, 4), random_values(24), false, 2);
  EXPECT_EQ(npy.substr(0, 8), std::string("\x93NUMPY\x01\0", 8));
  EXPECT_EQ(header_size(npy), 128U);
  EXPECT_EQ(static_cast<unsigned char>(npy[8]) + 256U * static_cast<unsigned char>(npy[9]), 118U);
  EXPECT_TRUE(header_text(npy).starts_with("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 4), }"));
}

// Half of what the double below 1/2 rounds to would be 1/2.
TEST(WriteNpy, HalvesStayOnTheSideOfTheThreshold) {
  const std::vector<double> values{0.5, std::nextafter(0.5, 0.0), std::nextafter(-0.5, 0.0), 1.0, 1e300, -0.0};
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.npy");
  OutputDescription description;
  description.precision = Precision::kHalf;
  const Lattice lattice = lattice_of(1, 1, 6);
  test::write_in_slabs(FieldFormat::kNpy, output, lattice, description, values, 1);
  const std::string npy = read_text(directory / "out.npy");
  EXPECT_TRUE(header_text(npy).starts_with("{'descr': '<f2'"));
  // 1/2, the half below it, minus the half below it, 1, 65504, 0
  const std::vector<std::uint16_t> expected{0x3800, 0x37FF, 0xB7FF, 0x3C00, 0x7BFF, 0};
  EXPECT_EQ(elements<std::uint16_t>(npy), expected);
}

TEST(WriteNpy, LatticesHaveZFastest) {
  // More samples than a tile of the transposition on each side, in slabs that do not divide them.
  const Lattice lattice = lattice_of(37, 5, 41);
  const std::vector<double> values = random_values(37 * 5 * 41);
  const auto actual = elements<double>(lattice_npy(lattice, values, true, 20));
  ASSERT_EQ(actual.size(), values.size());
  for (std::size_t i = 0; i < 37; ++i) {
    for (std::size_t j = 0; j < 5; ++j) {
      for (std::size_t k = 0; k < 41; ++k) {
        ASSERT_EQ(actual[(i * 5 + j) * 41 + k], values[(k * 5 + j) * 37 + i]) << i << ' ' << j << ' ' << k;
      }
    }
  }
}

TEST(WriteNpy, LatticesAreSinglePrecisionUnlessDoubleIsAsked) {
  const std::string npy = lattice_npy(lattice_of(1, 1, 2), {0.1, -0.0}, false, 1);
  const auto actual = elements<float>(npy);
  EXPECT_EQ(actual, (std::vector<float>{0.1F, 0.0F}));
  EXPECT_FALSE(std::signbit(actual[1]));
  EXPECT_TRUE(header_text(lattice_npy(lattice_of(1, 1, 2), {0.1, -0.0}, true, 1)).starts_with("{'descr': '<f8'"));
}

TEST(WriteNpy, LatticesDoNotDependOnTheSlabs) {
  const Lattice lattice = lattice_of(19, 4, 3);
  const std::vector<double> values = random_values(19 * 4 * 3);
  EXPECT_EQ(lattice_npy(lattice, values, false, 1), lattice_npy(lattice, values, false, 19));
}

TEST(WriteNpy, LatticesWithLargePlanesComeInSlabsAcrossYToFilesAndAcrossXToPipes) {
  const Lattice lattice = lattice_of(5, 300, 301);
  const std::vector<double> values = random_values(5 * 300 * 301);
  const TemporaryDirectory directory;
  OutputFile file(directory / "unused.npy"), other("/dev/null");
  EXPECT_EQ(make_lattice_writer(FieldFormat::kNpy, file, lattice, {})->slab_axis(), 1);
  EXPECT_EQ(make_lattice_writer(FieldFormat::kNpy, other, lattice, {})->slab_axis(), 0);
  const std::string expected = lattice_npy(lattice, values, false, 300);
  for (const std::int64_t thickness : {1, 7, 299}) EXPECT_EQ(lattice_npy(lattice, values, false, thickness), expected);
  const auto actual = elements<float>(expected);
  ASSERT_EQ(actual.size(), values.size());
  for (std::size_t n = 0; n < values.size(); ++n) {
    const std::size_t i = n % 5, j = n / 5 % 300, k = n / 1500;
    ASSERT_EQ(actual[(i * 300 + j) * 301 + k], static_cast<float>(values[n])) << n;
  }
}

TEST(WriteNpy, LatticesOfOneLayerAreCutWhereThatIsPossible) {
  const TemporaryDirectory directory;
  OutputFile file(directory / "unused.npy");
  const auto axis = [&](const Lattice& lattice) {
    return make_lattice_writer(FieldFormat::kNpy, file, lattice, {})->slab_axis();
  };
  EXPECT_EQ(axis(lattice_of(100'000, 1, 100'000)), 0) << "one slab across y would be all of it";
  EXPECT_EQ(axis(lattice_of(2048, 2048, 2048)), 1);
  EXPECT_EQ(axis(lattice_of(1000, 50, 50)), 0) << "slabs across x hold long rows";
}

// Writes `values` as points to `name`, announcing their number or not.
void write_points(const std::string& name, const std::vector<double>& values, bool announce) {
  OutputFile output(name);
  const auto size = announce ? std::optional<std::uint64_t>(values.size()) : std::nullopt;
  const auto writer = make_point_writer(FieldFormat::kNpy, output, size, {});
  const std::vector<Vec3> points(values.size());
  const std::size_t half = values.size() / 2;
  const FieldValues first = std::span(values).first(half), second = std::span(values).subspan(half);
  writer->write(std::span(points).first(half), {&first, 1});
  writer->flush();
  writer->write(std::span(points).subspan(half), {&second, 1});
  writer->finish();
}

std::string points_npy(const std::vector<double>& values, bool announce) {
  const TemporaryDirectory directory;
  write_points(directory / "out.npy", values, announce);
  return read_text(directory / "out.npy");
}

std::string points_npy_through_pipe(const std::vector<double>& values, bool announce) {
  return test::received_through_pipe([&](const std::string& path) { write_points(path, values, announce); });
}

TEST(WriteNpy, PointsAreOneAxisOfDoubles) {
  const std::vector<double> values = random_values(1001);
  const std::string npy = points_npy(values, true);
  EXPECT_TRUE(header_text(npy).starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (1001,), }"));
  EXPECT_EQ(header_size(npy) % 64, 0U);
  EXPECT_EQ(elements<double>(npy), values);
}

TEST(WriteNpy, PointsAreTheSameWhetherTheirNumberIsKnownOrNot) {
  for (const std::size_t count : {0U, 1U, 1000U, 300000U}) {
    const std::vector<double> values = random_values(count);
    const std::string expected = points_npy(values, true);
    EXPECT_EQ(points_npy(values, false), expected) << count;
    EXPECT_EQ(points_npy_through_pipe(values, true), expected) << count;
    EXPECT_EQ(points_npy_through_pipe(values, false), expected) << count;
  }
}

TEST(WriteNpy, PointsMustBeAsManyAsAnnounced) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.npy");
  const auto writer = make_point_writer(FieldFormat::kNpy, output, 2, {});
  const std::vector<double> values(1);
  const FieldValues field = std::span(values);
  writer->write(std::vector<Vec3>(1), {&field, 1});
  EXPECT_THROW(writer->finish(), std::logic_error);
}

TEST(WriteNpy, PointsWithDiagnosticsAreRowsOfFive) {
  const TemporaryDirectory directory;
  test::FourDiagnostics of;
  for (const std::size_t count : {0U, 4U}) {
    OutputFile output(directory / "out.npy");
    const auto writer = make_point_writer(FieldFormat::kNpy, output, std::nullopt, test::described_with_diagnostics());
    const std::vector<double> values{0.25, 1, 0, -2};
    for (std::size_t n = 0; n < count; n += 2) {
      writer->write(std::vector<Vec3>(2), of.from(n, std::span(values).subspan(n, 2)));
    }
    writer->finish();
    const std::string npy = read_text(directory / "out.npy");
    EXPECT_NE(header_text(npy).find("'shape': (" + std::to_string(count) + ", 5), }"), std::string::npos);
    std::vector<double> expected;
    for (std::size_t n = 0; n < count; ++n) {
      expected.insert(expected.end(),
                      {values[n], static_cast<double>(of.crossings[n]), static_cast<double>(of.degenerate[n]),
                       static_cast<double>(of.on_surface[n]), of.error_bound[n]});
    }
    if (count > 0) {
      EXPECT_EQ(elements<double>(npy), expected);
    }
  }
}

TEST(WriteNpy, LatticesOfFlagsAreBooleans) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.npy");
  OutputDescription description;
  description.fields.front().kind = FieldKind::kFlag;
  description.precision = Precision::kDouble;  // of numbers, not of flags
  const auto writer = make_lattice_writer(FieldFormat::kNpy, output, lattice_of(2, 1, 2), description);
  const std::vector<std::uint8_t> flags{1, 0, 0, 1};  // x fastest
  const FieldValues field = std::span(flags);
  writer->write(whole(lattice_of(2, 1, 2)), {&field, 1});
  writer->finish({});
  const std::string npy = read_text(directory / "out.npy");
  EXPECT_TRUE(header_text(npy).starts_with("{'descr': '|b1', 'fortran_order': False, 'shape': (2, 1, 2), }"));
  EXPECT_EQ(npy.substr(header_size(npy)), std::string("\1\0\0\1", 4));
}

TEST(WriteNpy, NumpyReadsIt) {
  if (!test::python_has("numpy")) GTEST_SKIP() << "no numpy in /usr/bin/python3";
  const TemporaryDirectory directory;
  OutputFile output(directory / "lattice.npy");
  const Lattice lattice = lattice_of(3, 4, 5);
  std::vector<double> values(60);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<double>(n);
  test::write_in_slabs(FieldFormat::kNpy, output, lattice, {}, values, 2);
  write_points(directory / "points.npy", {0.1, 0.2, 0.3}, false);
  EXPECT_EQ(test::run_python("import numpy, sys\n"
                             "a = numpy.load(sys.argv[1] + '/lattice.npy')\n"
                             "assert a.shape == (3, 4, 5) and a.dtype == numpy.float32 and a.flags.c_contiguous\n"
                             "assert all(a[i, j, k] == (k * 4 + j) * 3 + i for i, j, k in numpy.ndindex(a.shape))\n"
                             "p = numpy.load(sys.argv[1] + '/points.npy')\n"
                             "assert p.dtype == numpy.float64 and p.tolist() == [0.1, 0.2, 0.3]\n",
                             {directory.path().string()}),
            "");
}

}  // namespace
}  // namespace raycone
