// raycone report. Black box.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/app/batch/batch_fixture.h"

namespace raycone::test {
namespace {

class Report : public Batch {};

TEST_F(Report, ShowsAllMeshesOfAllShardsOnASelfContainedPage) {
  put("a&b.obj");
  put("c.obj", triangle_soup(3));
  put("bad.obj", "v 1 <2> 3\n");
  for (const char* const shard : {"1/2", "2/2"}) (void)run({"--shard", shard, "--quiet"});
  ASSERT_EQ(run_raycone({"report", out_}).status, 0);
  const std::string page = read_text(out_ + "/report.html");
  for (const char* const expected :
       {"a&amp;b.obj", "c.obj", "bad.obj", "&lt;2&gt;", "<svg", "exterior edges", "data:image/bmp;base64,Qk",
        "<td class=\"bad\">invalid</td>", "Meshes finished 2", " UTC<br>\n<code>--format=npy"}) {
    EXPECT_NE(page.find(expected), std::string::npos) << expected;
  }
  EXPECT_LT(page.find("<h2>Failures"), page.find("<h2>Time against size"));
  for (const char* const reference : {"http", "src=\"/", "href", "url("}) {
    EXPECT_EQ(page.find(reference), std::string::npos) << "refers to another file: " << reference;
  }
  const CommandResult printed = run_raycone({"report", out_, "-o", "-"});
  EXPECT_EQ(printed.status, 0);
  EXPECT_EQ(printed.out, page);
}

// Whether it filters, a browser tells: report_page_test.py.
TEST_F(Report, CountsWarningsByName) {
  put("a.obj");
  put("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n");
  ASSERT_EQ(run({"--quiet"}).status, 0);
  const std::string page = run_raycone({"report", out_, "-o", "-"}).out;
  for (const char* const expected :
       {"<b>1</b>with warnings", "data-f=\"skipped-faces\">skipped-faces 1</button>", "<tr data-w=\"skipped-faces\">",
        "data-f=\"none\">none 1</button>", "<tr data-w=\"none\">"}) {
    EXPECT_NE(page.find(expected), std::string::npos) << expected;
  }
}

TEST_F(Report, OfABatchWithoutMeshesIsEmpty) {
  std::filesystem::create_directory(dir_ / "nothing");
  ASSERT_EQ(run_raycone({"batch", dir_ / "nothing", "--out-dir", out_}).status, 0);
  EXPECT_EQ(run_raycone({"report", out_}).status, 0);
  EXPECT_TRUE(std::filesystem::exists(out_ + "/report.html"));
}

// Its meshes are on no page: that is said, and only that.
TEST_F(Report, TellsOfRowsThatItCannotRead) {
  put("a.obj");
  put("b.obj");
  (void)run({"--quiet"});
  const std::string results = out_ + "/results.csv";
  const std::string whole = read_text(results);
  const auto report = [&] { return run_raycone({"report", out_}); };
  EXPECT_EQ(report().err.find("warning"), std::string::npos);
  std::string damaged = whole;
  damaged.replace(damaged.find(",ok,0,"), 6, ",ok,x,");
  write_text(results, damaged + "garbage\n");
  const CommandResult result = report();
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("2 rows cannot be read, left out"), std::string::npos) << result.err;
  write_text(results, whole.substr(0, whole.size() - 1));  // its last number may be cut short, too
  const CommandResult cut = report();
  EXPECT_EQ(cut.status, 0) << cut.err;
  EXPECT_NE(cut.err.find("1 row cannot be read, left out"), std::string::npos) << cut.err;
  std::filesystem::remove(results);
  EXPECT_EQ(report().status, 2);  // what rows were made from is no result
}

// A task of an array that never began has left nothing that could be missed.
TEST_F(Report, TellsOfShardsWithoutResults) {
  put("a.obj");
  for (const char* const shard : {"1/3", "3/3"}) (void)run({"--shard", shard, "--quiet"});
  const auto report = [&] { return run_raycone({"report", out_}); };
  const CommandResult result = report();
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("warning: " + out_ + ": no results of shard 2 of 3\n"), std::string::npos) << result.err;
  const std::string page = read_text(out_ + "/report.html");
  EXPECT_NE(page.find("There are no results of shard 2 of 3."), std::string::npos);
  EXPECT_EQ(run_raycone({"report", out_, "--quiet"}).err, "");

  (void)run({"--shard", "2/3", "--quiet"});
  EXPECT_EQ(report().err.find("warning"), std::string::npos);
  std::filesystem::remove(out_ + "/results-2-of-3.csv");
  EXPECT_NE(report().err.find("warning"), std::string::npos);
  (void)run({"--quiet"});  // does what is missing, and takes over the rest
  EXPECT_EQ(report().err.find("warning"), std::string::npos);
}

TEST_F(Report, OfWhatIsNoBatchIsAnInputError) {
  EXPECT_EQ(run_raycone({"report", dir_ / "absent"}).status, 2);
  EXPECT_EQ(run_raycone({"report", dir_.path().string()}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(dir_ / "report.html"));
  EXPECT_EQ(run_raycone({"report"}).status, 1);
}

}  // namespace
}  // namespace raycone::test
