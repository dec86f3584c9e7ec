// The example Makefile under GNU Make. Black box.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>

#include "tests/app/batch/batch_fixture.h"

namespace raycone::test {
namespace {

namespace fs = std::filesystem;

class Makefile : public Batch {
 protected:
  [[nodiscard]] std::vector<std::string> make(const std::string& resolution,
                                              const std::vector<std::string>& more = {}) {
    return with_more({"/usr/bin/make", "-j2", "-f", RAYCONE_DATA "/../app/make/Makefile", "MESHES=" + meshes_,
                      "FIELDS=" + out_, "OPTIONS=--resolution " + resolution, "RAYCONE=" + raycone_command({}).front()},
                     more);
  }

  void SetUp() override {
    if (!fs::exists("/usr/bin/make")) GTEST_SKIP() << "no GNU Make";
  }
};

TEST_F(Makefile, BuildsWhatIsMissingAndNothingElse) {
  put("a.obj");
  put("sub/b.OBJ");
  EXPECT_EQ(Command(make("8")).wait().status, 0);
  EXPECT_EQ(outputs_in(out_).size(), 2U);
  EXPECT_TRUE(fs::exists(out_ + "/sub/b.OBJ.vdb"));
  EXPECT_EQ(Command(make("8", {"--question"})).wait().status, 0) << "nothing to be done";
  const auto later = fs::last_write_time(out_ + "/a.obj.vdb") + std::chrono::seconds(1);
  fs::last_write_time(put("a.obj", kTriangle), later);
  EXPECT_EQ(Command(make("8", {"--question"})).wait().status, 1);
}

TEST_F(Makefile, AFailureCostsItsTargetOnly) {
  put("a.obj");
  put("b.obj", "broken");
  put("c.obj");
  EXPECT_EQ(Command(make("8", {"-k"})).wait().status, 2);
  EXPECT_EQ(outputs_in(out_).size(), 2U);
  EXPECT_FALSE(fs::exists(out_ + "/b.obj.vdb"));
  EXPECT_EQ(Command(make("8")).wait().status, 2);
}

TEST_F(Makefile, NamesAreNoCommands) {
  for (const char* const made : {"A", "B", "C"}) fs::remove(made);
  for (const char* const name : {"a`id>A`.obj", "b$(id>B).obj", "c&id>C&.obj", "d'e.obj", "f$g.obj"}) put(name);
  EXPECT_EQ(Command(make("4")).wait().status, 0);
  EXPECT_TRUE(fs::exists(out_ + "/d'e.obj.vdb"));
  EXPECT_TRUE(fs::exists(out_ + "/f$g.obj.vdb"));
  for (const char* const made : {"A", "B", "C"}) EXPECT_FALSE(fs::exists(made)) << made;
}

// What quotation cannot hide from Make itself.
TEST_F(Makefile, RefusesNamesThatMakeReadsOtherwise) {
  put("a1.obj");
  for (const char* const name : {"x;id>D;.obj", "a[12].obj", "a*.obj", "a?.obj", "a|b.obj", "a:b.obj", "a%b.obj"}) {
    const std::string path = put(name);
    const CommandResult result = Command(make("4")).wait();
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_NE(result.err.find("is in the name of a mesh"), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(out_)) << name;
    fs::remove(path);
  }
  EXPECT_FALSE(fs::exists("D"));
}

TEST_F(Makefile, AnInterruptLeavesNoPartialFile) {
  put("a.obj", triangle_soup(2000));
  put("b.obj", triangle_soup(2000));
  Command command(make("300 --threads 1"));  // a minute and more on any machine
  ASSERT_TRUE(becomes_true([this] { return fs::exists(out_) && outputs_in(out_).size() == 2; })) << "temporary files";
  command.send_signal(SIGTERM);
  EXPECT_NE(command.wait().status, 0);
  EXPECT_TRUE(becomes_true([this] { return outputs_in(out_).empty(); }));
}

}  // namespace
}  // namespace raycone::test
