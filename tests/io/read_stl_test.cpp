// The STL reader on good and on broken files, ASCII and binary.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/read_mesh.h"
#include "tests/support/reader_checks.h"

namespace raycone {
namespace {

using test::bytes_of;
using test::count_loading_prefixes;

ParsedMesh parse(const std::string& bytes) { return test::parse(read_stl, bytes); }
std::string error_of(const std::string& bytes) { return test::error_of(read_stl, bytes); }

const std::string kFacet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";
const std::vector<Vec3> kCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

// A header of 80 bytes that starts with `title`, `announced` as the number of triangles, then `triangles` of them.
std::string binary_file(std::string title, std::uint32_t announced, int triangles) {
  title.resize(80, ' ');
  std::string bytes = title + bytes_of({announced});
  for (int i = 0; i < triangles; ++i) {
    bytes += bytes_of({0.f, 0.f, 1.f});
    for (const Vec3& corner : kCorners)
      bytes += bytes_of({static_cast<float>(corner.x), static_cast<float>(corner.y), static_cast<float>(corner.z)});
    bytes += bytes_of<std::uint16_t>({0xffff});
  }
  return bytes;
}

TEST(ReadStl, AsciiTrianglesHaveThreeVerticesEach) {
  const ParsedMesh parsed = parse("solid a\n" + kFacet + kFacet + "endsolid a\n");
  std::vector<Vec3> twice = kCorners;
  twice.insert(twice.end(), kCorners.begin(), kCorners.end());
  EXPECT_EQ(parsed.mesh.vertices, twice);
  EXPECT_EQ(parsed.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_TRUE(parsed.warnings.empty());
}

TEST(ReadStl, BinaryTrianglesHaveThreeVerticesEach) {
  const ParsedMesh parsed = parse(binary_file("", 2, 2));
  EXPECT_EQ(parsed.mesh.vertices.size(), 6u);
  EXPECT_EQ(parsed.mesh.vertices[1], kCorners[1]);
  EXPECT_EQ(parsed.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_TRUE(parsed.warnings.empty());
}

TEST(ReadStl, BinaryWhoseHeaderStartsWithSolidIsBinary) {
  EXPECT_EQ(parse(binary_file("solid a\nfacet normal", 2, 2)).mesh.triangles.size(), 2u);
  EXPECT_EQ(parse(binary_file("solid a", 2, 2) + "x").mesh.triangles.size(), 2u);  // nor is its size exact
}

TEST(ReadStl, AsciiMayHoldSeveralSolids) {
  const ParsedMesh parsed = parse("solid a\n" + kFacet + "endsolid a\nsolid b\n" + kFacet + "endsolid b\n");
  EXPECT_EQ(parsed.mesh.triangles.size(), 2u);
}

TEST(ReadStl, AsciiMayStartWithBlanksOrAByteOrderMark) {
  EXPECT_EQ(parse(" \r\n\tsolid a\n" + kFacet + "endsolid a").mesh.vertices, kCorners);
  EXPECT_EQ(parse("\xEF\xBB\xBFsolid a\n" + kFacet + "endsolid a").mesh.vertices, kCorners);
}

TEST(ReadStl, AsciiKeywordsMayBeInAnyCase) {
  EXPECT_EQ(parse("SOLID\nFACET Normal 0 0 1\nOUTER LOOP\nVertex 0 0 0\nvertex 1 0 0\nVERTEX 0 1 0\nEndLoop\nENDFACET\n"
                  "EndSolid\n")
                .mesh.vertices,
            kCorners);
}

TEST(ReadStl, AsciiNumbersMayHaveExponents) {
  const ParsedMesh parsed = parse(
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 1.5e+01 -2E-1 +3e0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\nendsolid\n");
  EXPECT_EQ(parsed.mesh.vertices[0], (Vec3{15, -0.2, 3}));
}

TEST(ReadStl, AsciiNamesMayBeAnyBytes) {
  EXPECT_EQ(parse("solid \xff\xfe facet\n" + kFacet + "endsolid \xe6\x9c\n").mesh.vertices, kCorners);
}

std::string in_one_line(std::string text) {
  for (char& c : text)
    if (c == '\n') c = ' ';
  return text;
}

// Writers that lay out the text in other ways than everybody else.
TEST(ReadStl, AsciiFacetMayBeginInTheLineOfASolidOrEndsolid) {
  const std::size_t one = 1, two = 2;
  EXPECT_EQ(parse("solid " + kFacet + "endsolid\n").mesh.triangles.size(), one);
  EXPECT_EQ(parse("solid a b " + kFacet + kFacet + "endsolid a b\n").mesh.triangles.size(), two);
  EXPECT_EQ(parse("solid a\n" + kFacet + "endsolid a solid b " + kFacet).mesh.triangles.size(), two);
  EXPECT_EQ(parse("solid a\n" + kFacet + "end solid a\nsolid b\n" + kFacet + "end\tsolid").mesh.triangles.size(), two);
  std::string facet = kFacet;
  for (const std::string what : {"loop", "facet"}) facet.replace(facet.find("end" + what), 3, "end ");
  EXPECT_EQ(parse("solid a\n" + facet + "end solid a").mesh.triangles.size(), one);
  EXPECT_EQ(error_of("solid a\n" + kFacet + "end\nsolid b\n" + kFacet),
            "f:9: expected 'facet' or 'endsolid', found 'end'");
  EXPECT_EQ(parse(in_one_line("solid a\n" + kFacet + kFacet + "endsolid a")).mesh.triangles.size(), two);
  EXPECT_EQ(parse(in_one_line("SOLID\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0 VERTEX 1 0 0 VERTEX 0 1 0\n"
                              "ENDLOOP ENDFACET ENDSOLID"))
                .mesh.vertices,
            kCorners);
}

// "name: first triangle" of each group.
std::vector<std::string> groups_of(const std::string& text) {
  const FaceGroups groups = parse(text).groups;
  std::vector<std::string> all;
  for (const GroupRun& run : groups.runs) all.push_back(groups.names[run.group] + ": " + std::to_string(run.first));
  return all;
}

TEST(ReadStl, AsciiSolidMayBeginInTheLineOfAnEndsolid) {
  using Groups = std::vector<std::string>;
  const Groups both{"a: 0", "b: 2"};
  const std::string two = kFacet + kFacet;
  for (const std::string end : {"endsolid a", "endsolid", "ENDSOLID  a ", "endsolid other name", "end solid a"}) {
    for (const std::string between : {"\n", " ", "\n\n", "\t"}) {
      const std::string text = "solid a\n" + two + end + between + "solid b\n" + kFacet + "endsolid b\n";
      EXPECT_EQ(groups_of(text), both) << text;
      EXPECT_EQ(groups_of(in_one_line(text)), both) << text;
    }
  }
  EXPECT_EQ(groups_of("solid a\n" + two + "endsolid a SOLID b " + kFacet), both);
}

TEST(ReadStl, AsciiEndsolidMayNameASolidWithThatWordInItsName) {
  for (const std::string name : {"solid", "a solid", "my solid part", "solid facet", "a  solid"}) {
    const std::vector<std::string> both{name + ": 0", "b: 1"};
    const std::string text = "solid " + name + "\n" + kFacet + "endsolid " + name;
    EXPECT_EQ(groups_of(text + "\nsolid b\n" + kFacet + "endsolid b"), both) << name;
    EXPECT_EQ(groups_of(text + " solid b\n" + kFacet + "endsolid b"), both) << name;
    EXPECT_EQ(groups_of(text + "\n"), std::vector<std::string>{both[0]}) << name;
  }
  // Another name than the solid's.
  EXPECT_EQ(groups_of("solid a\n" + kFacet + "endsolid my solid\nsolid b\n" + kFacet),
            (std::vector<std::string>{"a: 0", "b: 1"}));
}

// A text that is read page by page: all pages but the last four read are protected, so that the system tells whenever
// another one is.
class CountedPages {
 public:
  explicit CountedPages(const std::string& text) : size_(text.size()) {
    start_ = static_cast<char*>(mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (start_ == MAP_FAILED) throw std::bad_alloc();
    text.copy(start_, size_);
    mprotect(start_, size_, PROT_NONE);
    counted_ = this;
    struct sigaction action {};
    action.sa_sigaction = [](int, siginfo_t* info, void*) { counted_->open(static_cast<char*>(info->si_addr)); };
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGSEGV, &action, &before_);
  }
  ~CountedPages() {
    sigaction(SIGSEGV, &before_, nullptr);
    munmap(start_, size_);
  }
  CountedPages(const CountedPages&) = delete;
  CountedPages& operator=(const CountedPages&) = delete;

  [[nodiscard]] std::string_view text() const { return {start_, size_}; }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  static constexpr std::size_t kPage = 4096;

  void open(char* at) {
    if (at < start_ || at >= start_ + size_) _exit(1);  // a real fault
    char*& oldest = open_[count_++ % open_.size()];
    if (oldest != nullptr) mprotect(oldest, kPage, PROT_NONE);
    oldest = start_ + static_cast<std::size_t>(at - start_) / kPage * kPage;
    mprotect(oldest, kPage, PROT_READ);
  }

  static CountedPages* counted_;
  char* start_ = nullptr;
  std::size_t size_;
  std::size_t count_ = 0;
  std::array<char*, 4> open_{};
  struct sigaction before_ {};
};
CountedPages* CountedPages::counted_ = nullptr;

std::size_t pages_read(int solids) {
  const std::string one = in_one_line("solid a\n" + kFacet + "endsolid a\n");
  std::string text;
  for (int n = 0; n < solids; ++n) text += one;
  const CountedPages pages(text);
  EXPECT_EQ(test::parse(read_stl, pages.text()).mesh.triangles.size(), static_cast<std::size_t>(solids));
  return pages.count();
}

TEST(ReadStl, AsciiSolidsInOneLineTakeTimeInProportion) {
  EXPECT_LT(pages_read(4000), 2.5 * static_cast<double>(pages_read(2000)));
}

TEST(ReadStl, AsciiNamesMayHoldKeywords) {
  for (const char* name : {"facet", "my facet normal", "facet normal 0 0 1", "facet normal export outer loop",
                           "loop # facet", "a\\", "solid facet"}) {
    EXPECT_EQ(parse("solid " + std::string(name) + "\n" + kFacet + "endsolid " + name + "\n").mesh.vertices, kCorners)
        << name;
  }
}

TEST(ReadStl, AsciiNormalsMayBeAnything) {
  EXPECT_EQ(parse("solid\nfacet normal nan -1.#IND 1.#QNAN\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                  "endloop\nendfacet\nendsolid\n")
                .mesh.vertices,
            kCorners);
}

TEST(ReadStl, AsciiLinesMayEndInAnyWay) {
  for (const std::string line_end : {"\r\n", "\r"}) {
    std::string text = "solid a\n" + kFacet + "endsolid a\n";
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += line_end.size())
      text.replace(at, 1, line_end);
    EXPECT_EQ(parse(text).mesh.vertices, kCorners);
  }
}

TEST(ReadStl, AsciiMayLackTheLastEndsolid) { EXPECT_EQ(parse("solid a\n" + kFacet).mesh.vertices, kCorners); }

TEST(ReadStl, AsciiWithoutFacetsHasNoTriangles) { EXPECT_TRUE(parse("solid a\nendsolid a\n").mesh.triangles.empty()); }

TEST(ReadStl, AsciiLoopOfFourVerticesIsFannedAndOfTwoSkipped) {
  const ParsedMesh parsed = parse(
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\n"
      "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n");
  EXPECT_EQ(parsed.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(parsed.warnings, (std::vector<Warning>{{"skipped-faces", "1 face with fewer than three corners skipped"}}));
}

TEST(ReadStl, AsciiErrorsNameTheLine) {
  EXPECT_EQ(error_of("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 x 0\n"),
            "f:5: expected a coordinate, found 'x'");
  EXPECT_EQ(error_of("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendfacet\n"),
            "f:5: expected 'vertex' or 'endloop', found 'endfacet'");
  EXPECT_EQ(error_of("solid\nfacet normal 0 0 1\nvertex 0 0 0\n"), "f:3: expected 'outer', found 'vertex'");
  EXPECT_EQ(error_of("solid\nface normal 0 0 1\n"), "f:2: expected 'facet' or 'endsolid', found 'face'");
  EXPECT_EQ(error_of("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
            "f:5: expected 'vertex' or 'endloop', found the end of the file");
  EXPECT_EQ(error_of("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 nan 0\nvertex 0 0 0\nvertex 1 1 1\nendloop\n"
                     "endfacet\n"),
            "f:4: a vertex that faces use has a coordinate that is not finite, expected finite numbers");
}

TEST(ReadStl, Utf16IsRefused) {
  EXPECT_EQ(error_of(std::string("\xFF\xFEs\0o\0", 6)), "f:1: the text is UTF-16, expected UTF-8 or ASCII");
}

TEST(ReadStl, BinaryCountBeyondTheLengthIsAnErrorThatNamesBoth) {
  EXPECT_EQ(error_of(binary_file("", 3, 2)), "f:byte 80: 3 triangles announced, but only 2 follow");
  EXPECT_EQ(error_of(binary_file("", 0xffffffff, 2)), "f:byte 80: 4294967295 triangles announced, but only 2 follow");
}

TEST(ReadStl, TextThatIsNoStlIsToldByItsFirstLine) {
  const std::string pointer =
      "version https://git-lfs.github.com/spec/v1\noid sha256:" + std::string(64, 'a') + "\nsize 1\n";
  EXPECT_EQ(error_of(pointer),
            "f:1: found 'version https://git-lfs.github.com/spec/v1', expected 'solid' or a binary STL");
}

TEST(ReadStl, PaddingBehindTextIsPassedOver) {
  for (const std::string& end : {std::string("\x1A"), std::string("\x1A\n"), std::string(700, '\0')}) {
    EXPECT_EQ(parse("solid a\n" + kFacet + "endsolid a\n" + end).mesh.triangles.size(), 1u);
  }
  EXPECT_EQ(parse("solid a\n" + kFacet + "endsolid\x1A").mesh.triangles.size(), 1u);
  EXPECT_EQ(parse("solid a\n" + kFacet + std::string("endsolid\0\0", 10)).mesh.triangles.size(), 1u);
  EXPECT_NE(error_of("solid a\n" + kFacet + "endsolid a\n\x1A!\n"), "");
}

TEST(ReadStl, BytesAfterTheLastBinaryTriangleAreWarnedAbout) {
  const ParsedMesh parsed = parse(binary_file("", 1, 2) + "x");
  EXPECT_EQ(parsed.mesh.triangles.size(), 1u);
  EXPECT_EQ(parsed.warnings,
            (std::vector<Warning>{{"trailing-data", "bytes after the announced number of triangles (1) ignored: 51"}}));
}

TEST(ReadStl, FilesTooShortForAHeaderAreRefused) {
  EXPECT_EQ(error_of("x"), "f:1: expected 'solid' or the 84 bytes that open a binary STL, the file has only 1");
}

TEST(ReadStl, BinaryNonFiniteCoordinateIsAnErrorAtItsByte) {
  std::string bytes = binary_file("", 1, 1);
  bytes.replace(84 + 12 + 12 + 4, 4, bytes_of({std::numeric_limits<float>::quiet_NaN()}));
  EXPECT_EQ(error_of(bytes),
            "f:byte 108: a vertex that faces use has a coordinate that is not finite, expected finite numbers");
}

TEST(ReadStl, EveryTruncationLoadsOrIsRefused) {
  const std::string text = "solid a\n" + kFacet + "endsolid a\n";
  EXPECT_GT(count_loading_prefixes(read_stl, text), 0);
  // From "solid" up to the first byte of the count, which is no zero, this is an ASCII file without facets.
  EXPECT_EQ(count_loading_prefixes(read_stl, binary_file("solid", 2, 2)), 77);
  EXPECT_EQ(count_loading_prefixes(read_stl, binary_file("x", 2, 2)), 0);
}

}  // namespace
}  // namespace raycone
