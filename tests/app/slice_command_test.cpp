// `raycone slice` from mesh to picture and numbers. Black box: the real executable.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/csv_numbers.h"
#include "tests/app/meshes.h"
#include "tests/support/output_checks.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

// What the header of a PNG says; nothing else is decoded here.
struct PictureSize {
  std::uint32_t width = 0, height = 0;
};

PictureSize size_of_png(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  if (bytes.size() < 24) return {};
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
    return value;
  };
  return {number(16), number(20)};
}

class Slice : public testing::Test {
 protected:
  Slice() { write_text(cube_, kCube); }

  CommandResult slice(std::vector<std::string> more) const {
    more.insert(more.begin(), {"slice", cube_, "-o", picture_});
    return run_raycone(more);
  }

  // The numbers of a slice of `rows` by `columns` pixels.
  std::vector<double> values(std::size_t rows, std::size_t columns) const {
    const std::string bytes = read_text(values_);
    const std::string shape = "(" + std::to_string(rows) + ", " + std::to_string(columns) + ")";
    EXPECT_NE(bytes.find(shape), std::string::npos) << bytes.substr(0, 128);
    EXPECT_NE(bytes.find("<f8"), std::string::npos);
    std::vector<double> numbers(rows * columns);
    if (bytes.size() < numbers.size() * sizeof(double)) return {};
    std::memcpy(numbers.data(), bytes.data() + bytes.size() - numbers.size() * sizeof(double),
                numbers.size() * sizeof(double));
    return numbers;
  }

  TemporaryDirectory dir_;
  std::string cube_ = dir_ / "cube.obj", picture_ = dir_ / "out.png", values_ = dir_ / "out.npy";
};

TEST_F(Slice, HasRowZeroAtTheTop) {
  // The cube fills the lower left quarter as seen from above: x to the right, y upwards.
  const CommandResult result = slice({"--bounds", "0,0,0,2,2,1", "--size", "8", "--values", values_});
  ASSERT_EQ(result.status, 0) << result.err;
  const PictureSize size = size_of_png(read_text(picture_));
  EXPECT_EQ(size.width, 8U);
  EXPECT_EQ(size.height, 8U);
  const std::vector<double> w = values(8, 8);
  ASSERT_EQ(w.size(), 64U);
  for (std::size_t row = 0; row < 8; ++row) {
    for (std::size_t column = 0; column < 8; ++column) {
      EXPECT_EQ(w[8 * row + column], row >= 4 && column < 4 ? 1.0 : 0.0) << row << ' ' << column;
    }
  }
}

TEST_F(Slice, LiesWhereItIsAskedFor) {
  for (const auto& [at, inside] : {std::pair{"50%", 1.0}, {"0.25", 1.0}, {"0%", 1.0}, {"100%", 0.0}}) {
    const CommandResult result = slice({"--axis", "y", "--at", at, "--size", "4", "--values", values_});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(values(4, 4), std::vector<double>(16, inside)) << at;
  }
}

TEST_F(Slice, AlongAnObliquePlaneIsThatAlongTheAxisIfTheyAreTheSame) {
  const std::vector<std::string> common{"--bounds", "0,0,0,2,1,1", "--size", "16", "--values", values_};
  ASSERT_EQ(slice(common).status, 0);
  const std::vector<double> expected = values(8, 16);
  const CommandResult result = slice(with_more(common, {"--normal", "0,0,1", "--up", "0,1,0"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(values(8, 16), expected);
}

// Where each value lies, from the report alone.
TEST_F(Slice, AlongAnObliquePlaneReportsItsLattice) {
  const std::string report = dir_ / "report.json";
  const CommandResult result = slice({"--normal", "1,1,0.5", "--padding", "20%", "--size", "12", "--field", "sdf",
                                      "--values", values_, "--report", report});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto lattice = nlohmann::json::parse(read_text(report))["lattice"];
  const auto width = lattice["index_max"][0].get<std::size_t>() + 1,
             height = lattice["index_max"][1].get<std::size_t>() + 1;
  EXPECT_EQ(lattice["index_max"][2], 0);
  const std::vector<double> distances = values(height, width);
  ASSERT_EQ(distances.size(), width * height);
  bool some_inside = false;
  for (std::size_t j = 0; j < height; ++j) {
    for (std::size_t i = 0; i < width; ++i) {
      double outside = 0.0, inside = -1.0;  // of the unit cube
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double x =
            lattice["origin"][axis].get<double>() +
            static_cast<double>(i) * lattice["spacing"][0].get<double>() * lattice["direction"][axis][0].get<double>() +
            static_cast<double>(j) * lattice["spacing"][1].get<double>() * lattice["direction"][axis][1].get<double>();
        const double beyond = std::abs(x - 0.5) - 0.5;
        outside += beyond > 0.0 ? beyond * beyond : 0.0;
        inside = std::max(inside, beyond);
      }
      const double expected = inside > 0.0 ? std::sqrt(outside) : inside;
      some_inside = some_inside || inside < -0.1;
      // Positions from the report differ from the pixels' by their rounding.
      EXPECT_NEAR(distances[(height - 1 - j) * width + i], expected, 1e-14) << i << ' ' << j;
    }
  }
  EXPECT_TRUE(some_inside);
}

// Far from the origin another formula for the places of pixels is off by a part of them.
TEST_F(Slice, HasDistancesAtTheSamplesOfItsLattice) {
  constexpr std::size_t kRows = 60;
  const std::string report = dir_ / "report.json", points = dir_ / "points.csv";
  std::string far;
  for (const int n : {0, 1, 2, 3, 4, 5, 6, 7}) {
    far += "v " + std::to_string(1000000000 + (n & 1)) + " " + std::to_string(1000000000 + (n >> 1 & 1)) + " " +
           std::to_string(1000000000 + (n >> 2)) + "\n";
  }
  write_text(cube_, far + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  for (const std::string axis : {"x", "y", "z"}) {
    ASSERT_EQ(slice({"--axis", axis, "--size", "60", "--field", "sdf", "--values", values_, "--report", report}).status,
              0);
    const nlohmann::json lattice = nlohmann::json::parse(read_text(report))["lattice"];
    const std::size_t across = axis == "x" ? 1 : 0, up = axis == "z" ? 1 : 2;
    const std::vector<double> distances = values(kRows, kRows);
    std::ostringstream rows;
    rows.precision(17);
    for (std::size_t row = 0; row < kRows; ++row) {
      for (std::size_t column = 0; column < kRows; ++column) {
        std::array<double, 3> q{lattice["origin"][0], lattice["origin"][1], lattice["origin"][2]};
        q[across] += static_cast<double>(column) * lattice["spacing"][across].get<double>();
        q[up] += static_cast<double>(kRows - 1 - row) * lattice["spacing"][up].get<double>();
        rows << q[0] << ',' << q[1] << ',' << q[2] << '\n';
      }
    }
    write_text(points, rows.str());
    const CommandResult result = run_raycone({"points", cube_, points, "--field", "sdf"});
    EXPECT_EQ(csv_numbers(result.out).column("sdf"), distances) << axis << ": " << result.err;
  }
}

TEST_F(Slice, ShowsAndWritesTheFieldAskedFor) {
  const std::vector<std::string> common{"--bounds", "-1,0,0,3,2,1", "--size", "4", "--at", "0.5", "--values", values_};
  const auto lower_row = [&](const std::vector<std::string>& more) {
    const CommandResult result = slice(with_more(common, more));
    EXPECT_EQ(result.status, 0) << result.err;
    const std::vector<double> two_rows = values(2, 4);
    return std::vector<double>(two_rows.begin() + 4, two_rows.end());
  };
  // x = -0.5, 0.5, 1.5, 2.5 at y = 0.5.
  EXPECT_EQ(lower_row({"--field", "inside"}), (std::vector<double>{0, 1, 0, 0}));
  EXPECT_EQ(lower_row({"--field", "sdf"}), (std::vector<double>{0.5, -0.5, 0.5, 1.5}));
  EXPECT_EQ(lower_row({"--field", "inside", "--rule", "threshold=0"}), (std::vector<double>{1, 1, 1, 1}));
  EXPECT_EQ(lower_row({"--field", "sdf", "--rule", "threshold=0"}), (std::vector<double>{-0.5, -0.5, -0.5, -1.5}));
  EXPECT_NE(read_text(picture_).find("signed distance by threshold=0 at z = 0.5"), std::string::npos);
}

TEST_F(Slice, ShowsLabelsOfParts) {
  const std::string other = dir_ / "other.obj";
  std::string moved = kCube;
  for (std::size_t at = 0; (at = moved.find("v 1", at)) != std::string::npos; ++at) moved.replace(at, 3, "v 2");
  write_text(other, moved);  // from x = 0 to 2
  const std::vector<std::string> common{other, "--bounds", "-1,0,0,3,2,1", "--size", "4", "--values", values_};
  const auto lower_row = [&](const std::vector<std::string>& more) {
    const CommandResult result = slice(with_more(with_more(common, {"--field", "label"}), more));
    EXPECT_EQ(result.status, 0) << result.err;
    const std::vector<double> two_rows = values(2, 4);
    return std::vector<double>(two_rows.begin() + 4, two_rows.end());
  };
  // x = -0.5, 0.5, 1.5, 2.5 at y = 0.5. Seen along the normal z, an oblique plane is the same one.
  for (const std::vector<std::string>& plane :
       std::vector<std::vector<std::string>>{{"--at", "0.5"}, {"--normal", "0,0,1", "--origin", "1,1,0.5"}}) {
    EXPECT_EQ(lower_row(plane), (std::vector<double>{0, 2, 2, 0}));
    std::vector<std::string> first_wins = plane;
    first_wins.push_back("--priority");
    EXPECT_EQ(lower_row(first_wins), (std::vector<double>{0, 1, 2, 0}));
  }
  EXPECT_NE(read_text(picture_).find("labels by threshold=0.5"), std::string::npos);
  // That a part is not in the picture is no reason for a warning.
  EXPECT_EQ(slice({other, "--field", "label", "--at", "100%", "--size", "1", "--padding", "1v", "--strict"}).status, 0);
  EXPECT_EQ(run_raycone({"slice", cube_, other, "-o", picture_}).status, 1);
}

// A plane is the same one through any of its points.
TEST_F(Slice, IsTheSameWhereItsOriginIsFarAway) {
  const auto at = [&](const std::string& origin) {
    const CommandResult result = slice(
        {"--normal", "0,0,1", "--origin", origin, "--field", "sdf", "--size", "8", "--values", values_, "--strict"});
    EXPECT_EQ(result.status, 0) << result.err;
    return values(8, 8);
  };
  const std::vector<double> expected = at("0,0,0.25");
  EXPECT_EQ(at("1e14,0,0.25"), expected);
  EXPECT_EQ(at("-1e16,1e17,0.25"), expected);
  EXPECT_NE(at("1e14,0,0.0625"), expected);  // another plane
}

TEST_F(Slice, HasAxesAndLegendWithinItsSizeAndTheSamplesBesideThem) {
  const std::vector<std::string> common{"--bounds", "0,0,0,2,1,1", "--size", "400", "--values", values_};
  ASSERT_EQ(slice(common).status, 0);
  const PictureSize framed = size_of_png(read_text(picture_));
  EXPECT_EQ(framed.width, 400U);
  EXPECT_EQ(values(200, 400).size(), 80'000U);
  std::vector<std::string> plain = common;
  plain.push_back("--no-legend");
  ASSERT_EQ(slice(plain).status, 0);
  const PictureSize size = size_of_png(read_text(picture_));
  EXPECT_EQ(size.width, 400U);
  EXPECT_EQ(size.height, 200U);
}

TEST_F(Slice, IsTheSameForAnyNumberOfThreads) {
  const std::string teapot = RAYCONE_DATA "/meshes/teapot.obj";
  const std::vector<std::string> words{"slice", teapot, "-o", "-", "--size", "90", "--normal", "1,2,3", "--quiet"};
  const CommandResult one = run_raycone(with_more(words, {"--threads", "1"}));
  EXPECT_EQ(size_of_png(one.out).width, 90U);
  EXPECT_TRUE(one.out == run_raycone(with_more(words, {"--threads", "2"})).out);
}

TEST_F(Slice, RefusesWhatItCannotDo) {
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{"--axis", "w"},
                                             {"--at", "half"},
                                             {"--normal", "0,0,0"},
                                             {"--origin", "0,0,0"},
                                             {"--normal", "1,0,0", "--axis", "x"},
                                             {"--size", "0"},
                                             {"--format", "vdb"},
                                             {"--field", "density"},
                                             {"--field", "label,inside"},
                                             {"--parts", "component"},
                                             {"--priority"},
                                             {"--field", "inside,sdf"},
                                             {"--rule", "odd"},
                                             {"--values", dir_ / "values.csv"}}) {
    const CommandResult result = slice(wrong);
    EXPECT_EQ(result.status, 1) << wrong.front() << ' ' << wrong.back();
    EXPECT_NE(result.err.find(wrong.front()), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(picture_));
  }
  const CommandResult twice = slice({"--values", picture_});
  EXPECT_EQ(twice.status, 1);
  EXPECT_NE(twice.err.find("is output and values"), std::string::npos) << twice.err;
  EXPECT_EQ(run_raycone({"slice", cube_}).status, 1);
  EXPECT_EQ(run_raycone({"slice", cube_, "-o", dir_ / "out.jpg"}).status, 1);
}

// --up has two meanings, and both matter to what is drawn.
TEST_F(Slice, ReportsBothOptionsUp) {
  const std::string report = dir_ / "report.json";
  ASSERT_EQ(slice({"--up", "y-to-z", "--normal", "0,0,1", "--up", "0,1,0", "--up", "1,0,0", "--size", "8", "--report",
                   report})
                .status,
            0);
  const std::string text = read_text(report);
  EXPECT_NE(text.find("\"--up=1,0,0\""), std::string::npos) << text;
  EXPECT_NE(text.find("\"--up=y-to-z\""), std::string::npos) << text;
  EXPECT_EQ(text.find("\"--up=0,1,0\""), std::string::npos) << text;
}

// A pixel takes 8 bytes as a number and, until it is one, 11 as a sample, and 8 where the mesh is open.
TEST_F(Slice, RefusesPicturesThatCannotFitWithTheNumber) {
  const std::string soup = dir_ / "soup.obj";
  write_text(soup, triangle_soup(200));
  const auto limited = [&](const std::vector<std::string>& more) {
    return run_raycone(with_more({"slice", soup, "-o", picture_, "--no-legend", "--threads", "1"}, more));
  };
  const CommandResult lattice = limited({"--size", "4000", "--memory-limit", "380M"});
  EXPECT_EQ(lattice.status, 4);
  EXPECT_NE(lattice.err.find("needs about "), std::string::npos) << lattice.err;
}

// A sheet of n x n squares.
std::string sheet(int n) {
  std::ostringstream obj;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) obj << "v " << i << ' ' << j << ' ' << (i * j) % 7 << '\n';
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j + 1, b = a + n + 1;
      obj << "f " << a << ' ' << b << ' ' << b + 1 << "\nf " << a << ' ' << b + 1 << ' ' << a + 1 << '\n';
    }
  }
  return obj.str();
}

// Which takes twenty times as long as the eight points.
TEST_F(Slice, ReportsThePreparationOfPointsAsSuch) {
  write_text(cube_, sheet(200));
  const std::string report = dir_ / "report.json";
  double largest = 0.0;  // a run may lose the processor while it evaluates
  for (int run = 0; run < 3; ++run) {
    ASSERT_EQ(slice({"--normal", "1,1,1", "--size", "8", "--report", report}).status, 0);
    const nlohmann::json seconds = nlohmann::json::parse(read_text(report))["seconds"];
    largest = std::max(largest, seconds["prepare"].get<double>() / seconds["evaluate"].get<double>());
  }
  EXPECT_GT(largest, 2.0);
}

TEST_F(Slice, LeavesNothingBehindWhereItFails) {
  const CommandResult large = slice({"--size", "1000000", "--memory-limit", "1G", "--values", values_});
  EXPECT_EQ(large.status, 4) << large.err;
  write_text(cube_, "v 0 0 0\nf 1 2 3\n");
  const CommandResult broken = slice({"--values", values_});
  EXPECT_EQ(broken.status, 2);
  EXPECT_NE(broken.err.find(cube_ + ":2"), std::string::npos) << broken.err;
  EXPECT_FALSE(std::filesystem::exists(picture_) || std::filesystem::exists(values_));
}

}  // namespace
}  // namespace raycone::test
