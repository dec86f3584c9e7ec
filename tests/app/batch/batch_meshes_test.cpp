#include "app/batch/batch_meshes.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "app/process/usage_error.h"
#include "io/files/file_error.h"
#include "tests/app/meshes.h"
#include "tests/support/error_text.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

namespace fs = std::filesystem;

class BatchMeshes : public testing::Test {
 protected:
  std::string put(const std::string& name) const {
    const fs::path path = dir_.path() / name;
    fs::create_directories(path.parent_path());
    write_text(path, kTriangle);
    return path.string();
  }

  [[nodiscard]] static std::vector<BatchMesh> find(const std::vector<std::string>& operands, bool full_names = false,
                                                   bool nul = false) {
    return find_meshes({operands, nul ? PathEnd::kNul : PathEnd::kLineFeed, full_names, "vdb"}).meshes;
  }

  [[nodiscard]] static std::vector<std::string> names(const std::vector<BatchMesh>& meshes) {
    std::vector<std::string> result;
    for (const BatchMesh& mesh : meshes) result.push_back(mesh.name);
    return result;
  }

  // What the UsageError of the search says.
  [[nodiscard]] static std::string error_of(const std::vector<std::string>& operands) {
    return error_text<UsageError>([&] { return find(operands); });
  }

  [[nodiscard]] std::string root_name() const { return dir_.path().filename().string(); }

  TemporaryDirectory dir_;
  std::string root_ = dir_.path().string();
};

using Names = std::vector<std::string>;

TEST_F(BatchMeshes, OfADirectoryAreFoundRecursivelyInByteOrder) {
  for (const char* const name : {"b.stl", "a/x.obj", "a-b.ply", "A.OFF", "a/y/z.GLB", "10.stl", "9.stl", "notes.txt",
                                 "\xC3\xA4 b.gltf", "stl", "a.stl.gz", "gz", "c.txt.gz", "d.PLY.Zst", "q.ObJ"}) {
    put(name);
  }
  const std::vector<BatchMesh> found = find({root_});
  EXPECT_EQ(names(found), (Names{"10.stl", "9.stl", "A.OFF", "a-b.ply", "a.stl.gz", "a/x.obj", "a/y/z.GLB", "b.stl",
                                 "d.PLY.Zst", "q.ObJ", "\xC3\xA4 b.gltf"}));
  EXPECT_EQ(found[4].output, "a.vdb");
  EXPECT_EQ(found[5].path, root_ + "/a/x.obj");
  EXPECT_EQ(found[5].output, "a/x.vdb");
  EXPECT_EQ(found[5].stamp, stamp_of(root_ + "/a/x.obj"));
  EXPECT_EQ(names(find({root_ + "/"})), names(found));
}

TEST_F(BatchMeshes, GivenByNameMayHaveAnyExtension) {
  const std::vector<BatchMesh> found = find({put("sub/mesh.dat"), put("sub/1234"), root_ + "/absent.stl"});
  EXPECT_EQ(names(found), (Names{"1234", "absent.stl", "mesh.dat"}));
  EXPECT_EQ(found[0].output, "1234.vdb");
  EXPECT_EQ(found[1].stamp, FileStamp{});
  EXPECT_EQ(found[2].output, "mesh.vdb");
}

TEST_F(BatchMeshes, OfListsAreOnePathALine) {
  const std::string a = put("sub/a b.stl");
  const std::string b = put("b\nc.stl");
  put("tree/d.obj");
  write_text(dir_ / "list", a + "\r\n\n" + root_ + "/tree\n");
  EXPECT_EQ(names(find({"@" + dir_ / "list"})), (Names{"a b.stl", "d.obj"}));
  write_text(dir_ / "nul", a + '\0' + b);
  EXPECT_EQ(names(find({"@" + dir_ / "nul"}, false, true)), (Names{"a b.stl", "b\nc.stl"}));
  EXPECT_THROW((void)find({"@" + dir_ / "absent"}), InputError);
}

TEST_F(BatchMeshes, WithOneOutputAreRefusedByBothNames) {
  const std::string stl = put("x/a.stl");
  const std::string obj = put("x/a.obj");
  const std::string other = put("y/a.stl");
  EXPECT_NE(error_of({root_ + "/x"}).find(obj + " and " + stl), std::string::npos) << error_of({root_ + "/x"});
  EXPECT_NE(error_of({stl, other}).find(stl + " and " + other), std::string::npos) << error_of({stl, other});
  const std::vector<BatchMesh> full = find({root_ + "/x"}, true);
  EXPECT_EQ(full[0].output, "a.obj.vdb");
  EXPECT_EQ(full[1].output, "a.stl.vdb");
  EXPECT_EQ(find({root_}, true).size(), 3U);
}

TEST_F(BatchMeshes, WithOneOutputAreAllListed) {
  std::string last;
  for (int i = 0; i < 12; ++i) {
    const std::string stem = "x/" + std::to_string(10 + i);
    put(stem + ".obj");
    last = put(stem + ".stl");
  }
  put("x/10.ply");
  const std::string error = error_of({root_ + "/x"});
  const std::string x = root_ + "/x/";
  EXPECT_NE(error.find(x + "10.obj, " + x + "10.ply and " + x + "10.stl: would all be written to 10.vdb; " + x +
                       "11.obj and " + x + "11.stl: would both be written to 11.vdb; "),
            std::string::npos)
      << error;
  EXPECT_TRUE(error.ends_with("19.vdb; and 2 more; --full-names keeps them apart")) << error;
  EXPECT_EQ(error.find(last), std::string::npos) << "ten are enough";
  EXPECT_NE(error_of({put("y/a.stl"), put("z/a.stl")}).find("would both be a.stl in the results; names are unique"),
            std::string::npos);
  std::vector<std::string> same;
  for (int i = 0; i < 100; ++i) same.push_back(put(std::to_string(i) + "/model.obj"));
  const std::string of_many = error_of(same);
  EXPECT_NE(of_many.find("/2/model.obj and 97 more: would all be model.obj in the results"), std::string::npos);
  EXPECT_LT(of_many.size(), 1000U) << of_many;
}

// A glTF refers to files beside itself.
TEST_F(BatchMeshes, LinksInOtherDirectoriesAreOtherMeshes) {
  const std::string one = put("one/a.gltf"), other = root_ + "/other/a.gltf";
  fs::create_directory(root_ + "/other");
  fs::create_hard_link(one, other);
  EXPECT_NE(error_of({one, other}).find("would both be a.gltf in the results"), std::string::npos);
  EXPECT_EQ(find({one, root_ + "/other/../one/a.gltf"}).size(), 1U);
}

TEST_F(BatchMeshes, HaveNamesHoweverTheyAreWritten) {
  put("tree/a.stl");
  for (const char* const form : {"/tree", "/tree/", "/tree//", "/tree/.", "/tree/../tree/", "/tree/./"}) {
    EXPECT_EQ(names(find({root_ + form})), Names{"a.stl"}) << form;
  }
  // Of a list any line is a mesh, if only one that will fail.
  const std::vector<std::pair<std::string, std::string>> missing{{"/no", "no"},
                                                                 {"/no/", "no/"},
                                                                 {"/no//", "no/"},
                                                                 {"/no/.", "no/"},
                                                                 {"/no/../", root_name() + "/"},
                                                                 {"/no/..", root_name() + "/"},
                                                                 {"/tree/a.stl/", "a.stl/"},
                                                                 {"/no/b.stl", "b.stl"}};
  for (const auto& [form, name] : missing) {
    write_text(dir_ / "list", root_ + form + "\n");
    EXPECT_EQ(names(find({"@" + dir_ / "list"})), Names{name}) << form;
  }
}

TEST_F(BatchMeshes, OfADirectoryThatIsMissingAreRefused) {
  put("a.stl");
  for (const char* const form : {"/no", "/no/", "/no/.", "/no/..", "/a.stl/"}) {
    EXPECT_THROW((void)find({root_ + "/a.stl", root_ + form}), InputError) << form;
  }
  for (const char* const empty : {"", "@"}) EXPECT_THROW((void)find({empty}), UsageError) << empty;
  EXPECT_EQ(names(find({root_ + "/no.stl"})), Names{"no.stl"});
}

TEST_F(BatchMeshes, GivenTwiceAreThereOnce) {
  const std::string a = put("a.stl");
  EXPECT_EQ(find({a, root_, root_ + "/./a.stl"}).size(), 1U);
}

TEST_F(BatchMeshes, LinksAreFollowedButNotInCircles) {
  put("a/b/mesh.stl");
  fs::create_directory_symlink(root_ + "/a", dir_ / "a/b/up");
  fs::create_directory_symlink(root_ + "/a/b", dir_ / "link");
  fs::create_symlink("nowhere.stl", dir_ / "dangling.stl");
  EXPECT_EQ(names(find({root_})), (Names{"a/b/mesh.stl", "dangling.stl", "link/mesh.stl"}));
}

TEST_F(BatchMeshes, PipesInDirectoriesArePassedOver) {
  ASSERT_EQ(mkfifo((dir_ / "pipe.stl").c_str(), 0600), 0);
  put("a.stl");
  EXPECT_EQ(names(find({root_})), (Names{"a.stl"}));
}

TEST_F(BatchMeshes, ADirectoryThatCannotBeReadStandsForWhatItHolds) {
  if (geteuid() == 0) GTEST_SKIP() << "nothing is forbidden to root";
  put("a.stl");
  put("closed/b.stl");
  fs::permissions(dir_ / "closed", fs::perms::none);
  EXPECT_EQ(names(find({root_})), (Names{"a.stl", "closed/"}));
  fs::permissions(dir_ / "closed", fs::perms::owner_all);
}

}  // namespace
}  // namespace raycone::test
