// `--diagnostics` and `--verify` from mesh to files. Black box: the real executable.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/csv_numbers.h"
#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/vdb_files.h"

namespace raycone::test {
namespace {

class DiagnosticsOption : public testing::Test {
 protected:
  DiagnosticsOption() {
    write_text(cube_, kCube);
    write_text(soup_, triangle_soup(20));
    std::ostringstream points;
    for (int n = 0; n < 5000; ++n)
      points << 0.002 * (n % 500) << ',' << 0.01 * (n % 97) << ',' << 0.01 * (n % 89) << '\n';
    write_text(points_, points.str());
  }

  TemporaryDirectory dir_;
  std::string cube_ = dir_ / "cube.obj";
  std::string soup_ = dir_ / "soup.obj";
  std::string points_ = dir_ / "points.csv";
};

using VerifyOption = DiagnosticsOption;

// `csv` without its last four columns.
std::string without_diagnostics(const std::string& csv) {
  std::istringstream lines(csv);
  std::ostringstream result;
  for (std::string line; std::getline(lines, line);) {
    for (int column = 0; column < 4; ++column) line.erase(std::min(line.rfind(','), line.size()));
    result << line << '\n';
  }
  return result.str();
}

TEST_F(DiagnosticsOption, AddsColumnsToPoints) {
  const CommandResult result =
      run_raycone({"points", cube_, "-", "--diagnostics"}, {.input = "0.5,0.5,0.25\n0,0,0\n2,0,0\n"});
  EXPECT_EQ(result.status, 0) << result.err;
  std::istringstream lines(result.out);
  std::string header, inside, corner, outside;
  std::getline(lines, header);
  std::getline(lines, inside);
  std::getline(lines, corner);
  std::getline(lines, outside);
  EXPECT_EQ(header, "x,y,z,w,crossings,degenerate,on_surface,error_bound");
  EXPECT_EQ(inside, "0.5,0.5,0.25,1,1,0,0,0");
  EXPECT_TRUE(corner.starts_with("0,0,0,1,1,") && corner.ends_with(",1,0")) << corner;
  EXPECT_EQ(outside, "2,0,0,0,0,0,0,0");
}

TEST_F(DiagnosticsOption, ChangesNoValue) {
  const std::vector<std::vector<std::string>> runs{{"lattice", soup_, "-o", "-", "--resolution", "20"},
                                                   {"points", soup_, points_}};
  for (std::vector<std::string> arguments : runs) {
    const std::string plain = run_raycone(arguments).out;
    arguments.push_back("--diagnostics");
    const CommandResult diagnosed = run_raycone(arguments);
    EXPECT_EQ(diagnosed.status, 0) << diagnosed.err;
    EXPECT_EQ(without_diagnostics(diagnosed.out), plain);
    EXPECT_GT(plain.size(), 5000U * 8U);
  }
}

TEST_F(DiagnosticsOption, BytesDependNotOnThreads) {
  for (const std::vector<std::string>& run :
       std::vector<std::vector<std::string>>{{"lattice", soup_, "-o", "-", "--resolution", "20"},
                                             {"lattice", soup_, "-o", "-", "--resolution", "20", "--format", "vdb"},
                                             {"points", soup_, points_},
                                             {"points", soup_, points_, "-o", "-", "--format", "npy"}}) {
    std::set<std::string> contents;
    for (const std::string threads : {"1", "2", "7"}) {
      const CommandResult result =
          run_raycone(with_more(run, {"--diagnostics", "--verify", "10", "--threads", threads}));
      EXPECT_EQ(result.status, 0) << result.err;
      contents.insert(result.out);
    }
    EXPECT_EQ(contents.size(), 1U);
    EXPECT_GT(contents.begin()->size(), 5000U * 8U);
  }
}

TEST_F(DiagnosticsOption, AnswersEachLineOfAReaderThatWaits) {
  Command command(raycone_command({"points", cube_, "-", "--quiet", "--diagnostics"}));
  EXPECT_EQ(command.read_line(), "x,y,z,w,crossings,degenerate,on_surface,error_bound");
  for (int i = 0; i < 3; ++i) {
    command.write("0.5 0.5 0.25\n");
    EXPECT_EQ(command.read_line(), "0.5,0.5,0.25,1,1,0,0,0");
  }
  command.close_input();
  EXPECT_EQ(command.wait().status, 0);
}

// How many rows of a CSV with diagnostics have something to compare.
struct Compared {
  int rows = 0, crossed = 0, ties = 0, on_surface = 0, bounded = 0;
};

Compared compare_grids_with_csv(const std::string& mesh, const std::string& path) {
  const std::vector<std::string> more{"--resolution", "12", "--diagnostics"};
  EXPECT_EQ(run_raycone(with_more({"lattice", mesh, "-o", path}, more)).status, 0);
  const CsvNumbers csv = csv_numbers(run_raycone(with_more({"lattice", mesh, "-o", "-"}, more)).out);
  const VdbGridPtr crossings = read_vdb_grid(path, "crossings");
  const VdbGridPtr degenerate = read_vdb_grid(path, "degenerate");
  const VdbGridPtr on_surface = read_vdb_grid(path, "on_surface", VdbType::kBool);
  const VdbGridPtr error_bound = read_vdb_grid(path, "error_bound");
  Compared compared;
  for (const std::vector<double>& row : csv.rows) {
    const VoxelIndex at = voxel_of(row);
    const double crossings_in_csv = row.at(7), degenerate_in_csv = row.at(8), on_surface_in_csv = row.at(9),
                 bound = row.at(10);
    ++compared.rows;
    EXPECT_EQ(crossings->value(at), crossings_in_csv);
    EXPECT_EQ(degenerate->value(at), degenerate_in_csv);
    EXPECT_EQ(on_surface->value(at), on_surface_in_csv != 0 ? 1 : 0);
    const double stored = error_bound->value(at);
    EXPECT_TRUE(stored >= bound && stored <= bound * (1 + 0x1p-22)) << stored << " for " << bound;  // rounded up
    EXPECT_LT(bound, 1e-12);
    compared.crossed += crossings_in_csv != 0;
    compared.ties += degenerate_in_csv != 0;
    compared.on_surface += on_surface_in_csv != 0;
    compared.bounded += bound > 0;
  }
  return compared;
}

TEST_F(DiagnosticsOption, GridsOfAVdbAreTheColumnsOfTheCsv) {
  const Compared soup = compare_grids_with_csv(soup_, dir_ / "soup.vdb");
  EXPECT_GT(soup.rows, 1000);
  EXPECT_GT(soup.crossed, 0);
  EXPECT_EQ(soup.bounded, soup.rows);
  const Compared cube = compare_grids_with_csv(cube_, dir_ / "cube.vdb");  // samples on faces, edges and corners
  EXPECT_EQ(cube.rows, 12 * 12 * 12);
  EXPECT_EQ(cube.on_surface, 12 * 12 * 12 - 10 * 10 * 10);
  EXPECT_GT(cube.ties, 100);
  EXPECT_EQ(cube.bounded, 0);
}

TEST_F(DiagnosticsOption, NpyOfALatticeIsAUsageErrorThatNamesTheFormats) {
  const CommandResult result = run_raycone({"lattice", dir_ / "absent.obj", "-o", "out.npy", "--diagnostics"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err, "raycone: --diagnostics: npy holds one number per sample, expected vdb, csv, npz or vti\n");
}

TEST_F(DiagnosticsOption, DoubleWidensTheValuesOnly) {
  const std::string path = dir_ / "out.vdb";
  ASSERT_EQ(run_raycone({"lattice", soup_, "-o", path, "--resolution", "8", "--double", "--diagnostics"}).status, 0);
  EXPECT_TRUE(read_vdb_grid(path, "winding", VdbType::kDouble));
  EXPECT_TRUE(read_vdb_grid(path, "error_bound", VdbType::kFloat));
  EXPECT_TRUE(read_vdb_grid(path, "on_surface", VdbType::kBool));
}

TEST_F(VerifyOption, IsInSummaryAndReport) {
  const std::string report = dir_ / "report.json";
  const CommandResult result = run_raycone(
      {"lattice", soup_, "-o", dir_ / "out.npy", "--resolution", "10", "--verify", "25", "--report", report});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find(", verified 25 samples, largest difference "), std::string::npos) << result.err;
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1);
  const auto verify = nlohmann::json::parse(read_text(report))["verify"];
  EXPECT_EQ(verify["samples"], 25);
  EXPECT_EQ(verify["on_surface"], 0);
  EXPECT_EQ(verify["unresolved"], 0);
  EXPECT_GT(verify["largest_difference"], 0.0);
  EXPECT_LE(verify["largest_difference"], verify["largest_bound"]);
  EXPECT_LT(verify["largest_bound"], 1e-12);
}

TEST_F(VerifyOption, SamplesDependOnTheJobAlone) {
  std::set<std::string> found;
  for (const std::string format : {"csv", "npy", "vdb"}) {  // npy goes through the lattice in another direction
    for (const std::string threads : {"1", "7"}) {
      const std::string report = dir_ / "report.json";
      EXPECT_EQ(run_raycone({"lattice", soup_, "-o", dir_ / "out", "--format", format, "--threads", threads, "--verify",
                             "5", "--resolution", "50", "--report", report})
                    .status,
                0);
      found.insert(nlohmann::json::parse(read_text(report))["verify"].dump());
    }
  }
  EXPECT_EQ(found.size(), 1U);
}

TEST_F(VerifyOption, CountsSamplesOnTheSurface) {
  const std::string report = dir_ / "report.json";
  const CommandResult result =
      run_raycone({"lattice", cube_, "-o", "-", "--resolution", "3", "--verify", "100", "--report", report});
  EXPECT_EQ(result.status, 0);
  const auto verify = nlohmann::json::parse(read_text(report))["verify"];
  EXPECT_EQ(verify["samples"], 27);
  EXPECT_EQ(verify["on_surface"], 26) << "all but the one inside";
  EXPECT_EQ(verify["unresolved"], 0);
}

TEST_F(VerifyOption, WorksOnStreams) {
  const CommandResult result = run_raycone({"points", soup_, "-", "--verify", "3"}, {.input = read_text(points_)});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, run_raycone({"points", soup_, points_}).out);
  EXPECT_NE(result.err.find(", verified 3 samples, "), std::string::npos) << result.err;
}

TEST_F(VerifyOption, TakesPositiveIntegers) {
  for (const char* const number : {"0", "-1", "1.5", "many", "1e3", "99999999999"}) {
    const CommandResult result = run_raycone({"points", soup_, points_, "--verify", number});
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.err.rfind(std::string("raycone: --verify ") + number + ": expected an integer from 1 to ", 0), 0U)
        << result.err;
  }
}

}  // namespace
}  // namespace raycone::test
