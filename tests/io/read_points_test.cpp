// open_points on text, NPY and PLY: what it accepts, what it says about the rest, and how it behaves on pipes.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/files/file_error.h"
#include "io/points/point_readers.h"
#include "io/points/read_points.h"
#include "tests/support/bytes.h"
#include "tests/support/error_text.h"
#include "tests/support/temporary_directory.h"

namespace raycone {
namespace {

using test::bytes_of;
using test::TemporaryDirectory;

std::vector<Vec3> read_all(PointReader& reader, std::size_t max = 1000) {
  std::vector<Vec3> points;
  for (std::vector<Vec3> batch; reader.next(batch, max);) {
    EXPECT_LE(batch.size(), max);
    EXPECT_FALSE(batch.empty());
    points.insert(points.end(), batch.begin(), batch.end());
  }
  return points;
}

class ReadPoints : public testing::Test {
 protected:
  std::vector<Vec3> read(const std::string& bytes, const ReadPointsOptions& options = {}) {
    return read_all(*open(bytes, options));
  }

  std::unique_ptr<PointReader> open(const std::string& bytes, const ReadPointsOptions& options = {}) {
    std::ofstream(path_, std::ios::binary) << bytes;
    return open_points(path_, options);
  }

  // The message of the InputError, without the directory of the file.
  std::string error_of(const std::string& bytes, const ReadPointsOptions& options = {}) {
    const std::string message = test::error_text<InputError>([&] { return read(bytes, options); });
    return message.starts_with(path_) ? message.substr(path_.size() - 3) : message;
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_ / "pts";
};

const std::vector<Vec3> kTwo{{1, 2, 3}, {-4, 0.5, 6e-3}};
const ReadPointsOptions kFromTheSecondOn{.columns = {{2, 3, 4}}, .raw = {}};

// --- Text -----------------------------------------------------------------------------------------------------------

TEST_F(ReadPoints, CommasSemicolonsTabsAndBlanksSeparateColumns) {
  EXPECT_EQ(read("1,2,3\n-4,.5,6e-3\n"), kTwo);
  EXPECT_EQ(read("1;2;3\n-4;.5;6e-3\n"), kTwo);
  EXPECT_EQ(read("1\t2\t3\n-4\t.5\t6e-3\n"), kTwo);
  EXPECT_EQ(read("  1 2   3\n-4 \t .5 6e-3  \n"), kTwo);
  EXPECT_EQ(read("1, 2 ,3\n -4 , +.5,6e-3 \n"), kTwo);
}

TEST_F(ReadPoints, HeaderBlankLinesCommentsQuotesAndCrlfAreFine) {
  EXPECT_EQ(
      read("\xEF\xBB\xBF# made by hand\r\n\r\n\"x\",\"y\",\"z\"\r\n\"1\",\"2\",3\r\n \r\n#4,4,4\r\n-4,.5,6e-3 # end"),
      kTwo);
}

TEST_F(ReadPoints, LinesEndInLfCrLfOrCr) {
  for (const std::string first : {"\n", "\r\n", "\r"}) {
    for (const std::string second : {"\n", "\r\n", "\r"}) {
      EXPECT_EQ(read("x,y,z,n" + first + "1,2,3,7" + second + "-4,.5,6e-3,7" + first), kTwo);
      EXPECT_EQ(read("1 2 3 7" + first + "# c" + second + first + "-4 .5 6e-3 7"), kTwo);
      const std::string line = second + first == "\r\n" ? ":3:" : ":4:";
      EXPECT_NE(error_of("1 2 3" + first + "1 2 3" + second + first + "1 x 3").find(line), std::string::npos) << line;
    }
  }
}

TEST_F(ReadPoints, DelimitersWithinCommentsDoNotCount) {
  EXPECT_EQ(read("1 2 3 # a,b\n-4 .5 6e-3\n"), kTwo);
  EXPECT_EQ(read("1;2;3;#a,b\n-4;.5;6e-3\n"), kTwo);
  EXPECT_EQ(read("1\t2\t3\t# a;b,c\n-4\t.5\t6e-3\n"), kTwo);
}

TEST_F(ReadPoints, FurtherColumnsAreIgnored) { EXPECT_EQ(read("1,2,3,red,\"a, \"\"b\"\"\",\n-4,.5,6e-3,,,\n"), kTwo); }

TEST_F(ReadPoints, HeaderNamesTheColumnsWhereverTheyStand) {
  EXPECT_EQ(read("id,z,y,x\n7,3,2,1\n8,6e-3,.5,-4\n"), kTwo);
  EXPECT_EQ(read("X Y w Z\n1 2 9 3\n-4 .5 9 6e-3\n"), kTwo);
  EXPECT_EQ(read("\"w\",\"Points:0\",\"Points:1\",\"Points:2\"\n9,1,2,3\n9,-4,.5,6e-3\n"), kTwo);
}

TEST_F(ReadPoints, DelimiterIsThatOfTheRows) {
  EXPECT_EQ(read("Nr;x;y;z;Bemerkung, kurz\n7;1;2;3;a\n7;-4;.5;6e-3;b\n"), kTwo);
  EXPECT_EQ(read("time, s\tx\ty\tz\n0.5\t1\t2\t3\n0.7\t-4\t.5\t6e-3\n"), kTwo);
  EXPECT_EQ(read("x\ty\tz\tnote\n1\t2\t3\ta, b\n-4\t.5\t6e-3\t\n"), kTwo);
  EXPECT_EQ(read("x;y;z;note\n1;2;3;a, b\n-4;.5;6e-3;\n"), kTwo);
  EXPECT_EQ(read("1,2,3,a;b\n-4,.5,6e-3,c\td\n"), kTwo);
  EXPECT_EQ(read("z,y,x\n3 2 1\n6e-3 .5 -4\n"), kTwo);
  EXPECT_EQ(read("5;1;2;3;a,7,8,9\n6;-4;.5;6e-3;\n", kFromTheSecondOn), kTwo);
  // No other character decides that what is not a number is one.
  for (const char* const line : {"10 5\t-4\t1.25", "10,5 -4,0 1,25", "10,5\t-4,0\t1,25", "1,5;2;3", "1\t2,5\t3"}) {
    EXPECT_NE(error_of(std::string(line) + "\n").find("expected a"), std::string::npos) << line;
  }
}

TEST_F(ReadPoints, NamesOfColumnsMayHaveWordsThatSayLittle) {
  for (const char* const header :
       {"OBJECTID,POINT_X,POINT_Y,POINT_Z", "t,pos_x,pos_y,pos_z", "id,x_mm,y_mm,z_mm", "n,coord.x,coord.y,coord.z",
        "n,X (m),Y (m),Z (m)", "id,P.x,P.y,P.z", "n,center_x,center_y,center_z", "n,//X,Y,Z"}) {
    EXPECT_EQ(read(std::string(header) + "\n7,1,2,3\n8,-4,.5,6e-3\n"), kTwo) << header;
  }
  for (const char* const header :
       {"id,center_x,center_y,center_z,pos_x,pos_y,pos_z", "id,P.x,P.y,P.z,point_x,point_y,point_z"}) {
    EXPECT_EQ(read(std::string(header) + "\n7,8,9,0,1,2,3\n8,9,0,1,-4,.5,6e-3\n"), kTwo) << header;
  }
  EXPECT_EQ(read("n,X [m],Y [m],Z [m],pos_x\n7,1,2,3,0\n8,-4,.5,6e-3,0\n"), kTwo);
  EXPECT_EQ(read("n,x (m),y (m),z (m),x_ft,y_ft,z_ft\n7,1,2,3,0,0,0\n8,-4,.5,6e-3,0,0,0\n"), kTwo);
  // Of velocities, normals and two points nobody knows.
  for (const char* const header :
       {"a,b,c,vel_x,vel_y,vel_z", "px,py,pz,nx", "x y,b,c,z", "a,b,c,pos_x,x_mm,pos_y,pos_z"}) {
    EXPECT_EQ(read(std::string(header) + "\n1,2,3,7,8,9,0\n-4,.5,6e-3,7,8,9,0\n"), kTwo) << header;
  }
}

TEST_F(ReadPoints, PlyInAPipeIsTold) {
  std::ofstream(path_) << "ply\nformat ascii 1.0\n";
  const auto reader = read_text_points(std::make_unique<InputBuffer>(path_), {});
  EXPECT_EQ(test::error_text<InputError>([&] { return read_all(*reader); }),
            path_ + ":1: found 'ply', expected text; PLY is read from files by their names");
}

// A title is no table of no points.
TEST_F(ReadPoints, HeadersWithoutRowsNameColumns) {
  EXPECT_EQ(error_of("hello\n"), "pts:1: found 'hello', expected a point, or names of columns");
  EXPECT_EQ(error_of("# none\n\n\"two words\"\n\n# end\n"),
            "pts:3: found '\"two words\"', expected a point, or names of columns");
  EXPECT_EQ(read("hello\n1 2 3\n-4 .5 6e-3\n"), kTwo);
  for (const char* const table : {"x,y,z\n", "a b c\n", "note;x;y;z", "one\ttwo\tthree\tfour\n"}) {
    EXPECT_TRUE(read(table).empty()) << table;
  }
  EXPECT_EQ(error_of("x,y,z\n", kFromTheSecondOn), "pts:1: found 'x,y,z', expected a point, or names of columns");
}

TEST_F(ReadPoints, DecimalCommasBelowAHeaderAreTold) {
  EXPECT_EQ(error_of("x;y;z\n1,5;2,5;3,5\n"), "pts:2: column 1 is '1,5', expected a finite number");
  EXPECT_EQ(error_of("x\ty\tz\n1\t2,5\t3\n"), "pts:2: column 2 is '2,5', expected a finite number");
  EXPECT_EQ(error_of("x y z\n1 2 3,5\n"), "pts:2: column 3 is '3,5', expected a finite number");
}

// Where names and fields are not as many, fields may be those of other columns.
TEST_F(ReadPoints, HeaderThatNamesColumnsHasAsManyAsTheRows) {
  for (const char* const table :
       {"\"x\" \"y\" \"z\"\n\"1\" 10.5 -4 1.25\n", "\"x\",\"y\",\"z\"\n\"1\",10.5,-4,1.25\n",
        " x y z\n0 10.5 -4 1.25\n", "% x y z w\n10.5 -4 1.25 5\n", "Node number x y z\n7 10.5 -4 1.25 1 2\n",
        "x,y,z\n10,5,-4,0,1,25\n", "x y z note\n1 2 3\n"}) {
    EXPECT_NE(error_of(table).find("pts:2: the header has "), std::string::npos) << table;
  }
  EXPECT_EQ(error_of("x,y,z\n7,1,2,3\n"),
            "pts:2: the header has 3 columns, and the first row 4, expected as many, or --columns");
  EXPECT_EQ(read("x,y,z\n7,1,2,3\n8,-4,.5,6e-3\n", kFromTheSecondOn), kTwo);
  EXPECT_EQ(read("x,y,z\n1,2,3,\n-4,.5,6e-3,\n"), kTwo) << "delimiters at the end";
  EXPECT_EQ(read("x,y,z,\n1,2,3\n-4,.5,6e-3\n"), kTwo);
  EXPECT_EQ(read("x,y,z,note\n1,2,3\n-4,.5,6e-3,a\n"), kTwo) << "the last fields of a row are missing";
  EXPECT_EQ(read("x,y,z,note\n1,2,3 # a, b\n-4,.5,\"6e-3\" # a, b\n"), kTwo) << "comments";
}

TEST_F(ReadPoints, ColumnOfRowNumbersIsNotX) {
  EXPECT_EQ(error_of(",px,py,pz\n0,10.5,-4,1.25\n"),
            "pts:2: the first column has no name, expected columns x, y and z, or --columns");
  EXPECT_EQ(read("id,X,Y,z\n0,1,2,3\n1,-4,.5,6e-3\n"), kTwo);
  EXPECT_EQ(read("id;z [mm];x(m) ;y [mm]\n0;3;1;2\n1;6e-3;-4;.5\n"), kTwo);
  EXPECT_EQ(read("a,b,c,x,X [m],Y,Z\n1,2,3,0,0,0,0\n-4,.5,6e-3,0,0,0,0\n"), kTwo) << "which x?";
  EXPECT_EQ(read("\"Point ID\",\"s\",\"Points_0\",\"Points_1\",\"Points_2\"\n0,3,1,2,3\n1,3,-4,.5,6e-3\n"), kTwo);
}

TEST_F(ReadPoints, MissingValuesAreNoHeader) {
  EXPECT_EQ(error_of("NA,NA,NA\n1,2,3\n"), "pts:1: column 1 is 'NA', expected a finite number");
  EXPECT_EQ(error_of("null;null;null\n1;2;3\n"), "pts:1: column 1 is 'null', expected a finite number");
  for (const std::string word : {"na", "n/a", "Null", "none", "<NA>", "NaN"}) {
    EXPECT_EQ(error_of(word + "," + word + "," + word + "\n1,2,3\n"),
              "pts:1: column 1 is '" + word + "', expected a finite number");
  }
}

TEST_F(ReadPoints, TextGluedToQuotesIsNoNumber) {
  EXPECT_EQ(error_of("\"10\".5,-4,1.25\n"), "pts:1: column 1 is '\"10\".5', expected a finite number");
  EXPECT_EQ(error_of("\"10.5\"9 -4 1.25\n"), "pts:1: column 1 is '\"10.5\"9', expected a finite number");
  EXPECT_EQ(read("\"1\" , \"2\" ,3\n-4,.5,\"6e-3\" \n"), kTwo);
}

TEST_F(ReadPoints, HeaderOfOtherNamesMeansTheFirstThreeColumns) {
  EXPECT_EQ(read("//X Y Z\n1 2 3\n-4 .5 6e-3\n"), kTwo);
  EXPECT_EQ(read("some title\n1,2,3\n-4,.5,6e-3\n"), kTwo);
}

TEST_F(ReadPoints, HeadersThatLeaveOpenWhichColumnsAreMeantAreWarnedAbout) {
  const auto warnings = [this](const std::string& header, const ReadPointsOptions& options = {}) {
    const std::unique_ptr<PointReader> reader = open(header + "\n7 1 2 3\n8 -4 .5 6e-3\n", options);
    EXPECT_TRUE(reader->warnings().empty()) << "nothing is known yet";
    (void)read_all(*reader);
    return reader->warnings();
  };
  EXPECT_EQ(warnings("id tx ty tz"),
            (std::vector<Warning>{{"columns",
                                   "the first three of 4 columns, 'id', 'tx' and 'ty', are taken for x, y and "
                                   "z, as no names tell; --columns takes others"}}));
  EXPECT_TRUE(warnings("id tx ty tz", kFromTheSecondOn).empty());
  EXPECT_TRUE(warnings("id x y z").empty());
  EXPECT_TRUE(warnings("//X Y Z I").empty());
  EXPECT_TRUE(warnings("# no header").empty());
  EXPECT_EQ(warnings("a title").at(0).text,
            "the first three of 4 columns are taken for x, y and z, as no names tell; --columns takes others");
}

TEST_F(ReadPoints, HeadersOfThreeColumnsThatNameAnAxisElsewhereAreWarnedAbout) {
  for (const std::string header : {"id x y", "X Z height", "t x[mm] y[mm]"}) {
    const std::unique_ptr<PointReader> reader = open(header + "\n1 2 3\n-4 .5 6e-3\n");
    EXPECT_EQ(read_all(*reader), kTwo) << header;
    ASSERT_EQ(reader->warnings().size(), 1U) << header;
    EXPECT_EQ(reader->warnings()[0].name, "columns");
  }
  const std::unique_ptr<PointReader> reader = open("id,x,y\n1,2,3\n-4,.5,6e-3\n");
  EXPECT_EQ(read_all(*reader), kTwo);
  EXPECT_EQ(reader->warnings().at(0).text,
            "the columns, 'id', 'x' and 'y', are taken for x, y and z, as no names tell; --columns takes others");
}

TEST_F(ReadPoints, HeadersOfThreeColumnsLeaveNothingOpen) {
  for (const char* const header : {"tx ty tz", "Scan of part 7", "a b c d e", "x y height"}) {
    const std::unique_ptr<PointReader> reader = open(std::string(header) + "\n1 2 3\n-4 .5 6e-3\n");
    EXPECT_EQ(read_all(*reader), kTwo);
    EXPECT_TRUE(reader->warnings().empty()) << header;
  }
  const std::unique_ptr<PointReader> reader = open("a,b,c,,\n1,2,3,,\n-4,.5,6e-3,,\n");
  EXPECT_EQ(read_all(*reader), kTwo);
  EXPECT_TRUE(reader->warnings().empty()) << "columns without names and values";
}

// A first line that is not read as numbers may be a point all the same: it must not be lost.
TEST_F(ReadPoints, HeaderNeedsAName) {
  const auto error = [this](const std::string& first) { return error_of(first + "\n1,2,3\n"); };
  EXPECT_EQ(error("1D0,2D0,3D0"), "pts:1: column 1 is '1D0', expected a finite number");
  EXPECT_EQ(error("0x1,0x2,0x3"), "pts:1: column 1 is '0x1', expected a finite number");
  EXPECT_EQ(error(",,"), "pts:1: column 1 is empty, expected a finite number");
  EXPECT_EQ(error(",,,name"), "pts:1: column 1 is empty, expected a finite number");
  EXPECT_EQ(error("-,-,-"), "pts:1: column 1 is '-', expected a finite number");
  EXPECT_EQ(error("\"1D0\",\"x\",\"y\""), "pts:1: column 1 is '1D0', expected a finite number");
  EXPECT_EQ(error("-.5d0,a,b"), "pts:1: column 1 is '-.5d0', expected a finite number");
  EXPECT_EQ(error("1m,2m,3m"), "pts:1: column 1 is '1m', expected a finite number");
  EXPECT_EQ(error("\u22121,\u22122,\u22123"), "pts:1: column 1 is '???1', expected a finite number");
  EXPECT_EQ(error("1D0,2D0,3D0,x"), "pts:1: column 1 is '1D0', expected a finite number");
  EXPECT_EQ(read("L\u00e4nge,Breite,H\u00f6he\n1,2,3\n-4,.5,6e-3\n"), kTwo);
  EXPECT_EQ(read("\"\",\"x\",\"y\",\"z\"\n0,1,2,3\n1,-4,.5,6e-3\n"), kTwo);  // of R and pandas
  EXPECT_EQ(read(",x,y,z\n0,1,2,3\n1,-4,.5,6e-3\n"), kTwo);
}

// The header test and the data must not differ about the delimiter.
TEST_F(ReadPoints, PointWithOtherDelimitersInItsTextIsNoHeader) {
  EXPECT_EQ(read("Smith, J.\t1\t2\t3\nDoe, A.\t-4\t.5\t6e-3\n", kFromTheSecondOn), kTwo);
  EXPECT_EQ(read("a,b;1;2;3\nc;-4;.5;6e-3\n", kFromTheSecondOn), kTwo);
  EXPECT_EQ(read("a;b,1,2,3\nc,-4,.5,6e-3\n", kFromTheSecondOn), kTwo);
  EXPECT_EQ(read("14\" pipe, x\t1\t2\t3\nc\t-4\t.5\t6e-3\n", kFromTheSecondOn), kTwo);
  EXPECT_EQ(read("x,y,z;1;2;3\nc;-4;.5;6e-3\n", kFromTheSecondOn), kTwo);
  EXPECT_EQ(read("x,y,z\t1\t2\t3\n", kFromTheSecondOn).size(), 1u);
  EXPECT_EQ(error_of("P1 1 2 3 a,b\nP2 -4 .5 6e-3 a\n", kFromTheSecondOn).substr(0, 16), "pts:1: column 2 ");
  EXPECT_EQ(error_of("a;b,1D0,2D0,3D0\nc,-4,.5,6e-3\n", kFromTheSecondOn).substr(0, 6), "pts:1:");
  EXPECT_EQ(error_of("id7, A\t.5\t.5\t.5\t\nid8\t.5\t.5\t.5\t\n"),
            "pts:1: column 1 is 'id7, A', expected a finite number");
}

TEST_F(ReadPoints, DelimitersWithinQuotesDoNotCountBetweenBlanks) {
  EXPECT_EQ(read("1 2 3 \"a;b\"\n-4 .5 6e-3 \"c, d\"\n"), kTwo);
  EXPECT_EQ(read("x y z \"a; 2\"\n1 2 3 4\n-4 .5 6e-3 5\n"), kTwo);
  EXPECT_EQ(read("\"a, b\" 1 2 3\nc -4 .5 6e-3\n", kFromTheSecondOn), kTwo);
  EXPECT_EQ(error_of("1 2 3x \"a;b\"\n"), "pts:1: column 3 is '3x', expected a finite number");
}

TEST_F(ReadPoints, HeaderMayHaveOtherDelimitersInItsNames) {
  EXPECT_EQ(read("east, m;north, m;height, m\n1;2;3\n-4;.5;6e-3\n"), kTwo);
  EXPECT_EQ(read("x;y;z;note, 2 words\n1;2;3;a\n-4;.5;6e-3;b\n"), kTwo);
  EXPECT_EQ(read("x,y,z,a;2\n1,2,3,4\n-4,.5,6e-3,5\n"), kTwo);
  EXPECT_EQ(read("field 1,field 2,field 3\n1,2,3\n-4,.5,6e-3\n"), kTwo);
  EXPECT_EQ(read("2nd id,x,y,z\n7,1,2,3\n8,-4,.5,6e-3\n"), kTwo);
}

TEST_F(ReadPoints, GivenColumnsWinOverNames) {
  ReadPointsOptions options;
  options.columns = {4, 2, 3};
  EXPECT_EQ(read("x,y,z,a\n0,2,3,1\n0,.5,6e-3,-4\n", options), kTwo);
  EXPECT_EQ(read("0,2,3,1\n0,.5,6e-3,-4\n", options), kTwo);
}

TEST_F(ReadPoints, NumbersAreTheNearestDoublesWhateverTheLocale) {
  const std::vector<Vec3> points = read("0.1 1e-400 -1e-400\n5e-324 1.7976931348623157e308 0.3\n");
  EXPECT_EQ(points[0], (Vec3{0.1, 0.0, 0.0}));
  EXPECT_EQ(points[1], (Vec3{5e-324, 1.7976931348623157e308, 0.3}));
}

TEST_F(ReadPoints, WhatIsNotAFiniteNumberIsAnErrorWithItsLine) {
  EXPECT_EQ(error_of("1,2,3\n\n1,abc,3\n"), "pts:3: column 2 is 'abc', expected a finite number");
  EXPECT_EQ(error_of("x,y,z\n1,2,1e400\n"), "pts:2: column 3 is '1e400', expected a finite number");
  EXPECT_EQ(error_of("nan,2,3\n"), "pts:1: column 1 is 'nan', expected a finite number");
  EXPECT_EQ(error_of("1,-inf,3\n"), "pts:1: column 2 is '-inf', expected a finite number");
  EXPECT_EQ(error_of("1,,3\n"), "pts:1: column 2 is empty, expected a finite number");
  EXPECT_EQ(error_of("1,2,3x\n"), "pts:1: column 3 is '3x', expected a finite number");
  EXPECT_EQ(error_of("1,\"2,3\n"), "pts:1: a quotation mark without its end, expected it in the same line");
}

TEST_F(ReadPoints, DecimalCommaIsAnErrorNotAnotherPoint) {
  EXPECT_EQ(error_of("1,5;2,5;3,5\n"), "pts:1: column 1 is '1,5', expected a finite number");
}

TEST_F(ReadPoints, TooFewColumnsAreAnError) {
  EXPECT_EQ(error_of("1 2 3\n1 2\n"), "pts:2: found '1 2' with 2 columns, expected at least 3");
  EXPECT_EQ(error_of("17\n1 2 3\n"), "pts:1: found '17' with 1 column, expected at least 3");
}

TEST_F(ReadPoints, OnlyTheFirstLineMayBeAHeader) {
  EXPECT_EQ(error_of("x,y,z\nu,v,w\n1,2,3\n"), "pts:2: column 1 is 'u', expected a finite number");
}

TEST_F(ReadPoints, BinaryDataAndEndlessLinesAreErrors) {
  EXPECT_EQ(error_of(std::string("a\0b", 3)), "pts:1: the input is binary, expected text");
  EXPECT_EQ(error_of("\xFF\xFEx\n"), "pts:1: the text is UTF-16, expected UTF-8");
  EXPECT_EQ(error_of("1,2,3\n" + std::string(5 << 20, '1')),
            "pts:2: line of more than 1048576 bytes, expected a point");
}

TEST_F(ReadPoints, MissingFilesAndDirectoriesAreErrors) {
  EXPECT_THROW(static_cast<void>(open_points(directory_ / "none")), InputError);
  EXPECT_THROW(static_cast<void>(read_all(*open_points(directory_.path().string()))), InputError);
}

TEST_F(ReadPoints, EmptyInputHasNoPoints) {
  EXPECT_TRUE(read("").empty());
  EXPECT_TRUE(read("x,y,z\n").empty());
}

TEST_F(ReadPoints, LinesAcrossBlocksAreWhole) {
  std::string text;
  std::vector<Vec3> expected;
  for (int i = 0; i < 100000; ++i) {
    text += std::to_string(i) + "," + std::to_string(i % 7) + ",0.5,some text\n";
    expected.push_back({static_cast<double>(i), static_cast<double>(i % 7), 0.5});
  }
  EXPECT_EQ(read(text), expected);
}

// --- Pipes ----------------------------------------------------------------------------------------------------------

// A FIFO of which the test holds the writing end.
class Fifo {
 public:
  explicit Fifo(const std::string& path) {
    if (mkfifo(path.c_str(), 0600) != 0) throw std::runtime_error("no FIFO: " + path);
    // The writing end opens only once there is a reader: Linux allows to be both.
    descriptor_ = ::open(path.c_str(), O_RDWR);
    if (descriptor_ < 0) throw std::runtime_error("cannot open FIFO: " + path);
  }
  ~Fifo() { close(); }
  Fifo(const Fifo&) = delete;
  Fifo& operator=(const Fifo&) = delete;

  void write(const std::string& text) const {
    ASSERT_EQ(::write(descriptor_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void close() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
  }

 private:
  int descriptor_ = -1;
};

TEST_F(ReadPoints, AnswersALineBeforeTheLfOfItsCrLfHasCome) {
  Fifo fifo(path_);
  fifo.write("1,2,3\r");
  const auto reader = open_points(path_);
  std::vector<Vec3> batch;
  ASSERT_TRUE(reader->next(batch, 10));
  EXPECT_EQ(batch, (std::vector<Vec3>{{1, 2, 3}}));
  EXPECT_TRUE(reader->would_block());
  fifo.write("\n4,5,6\r\n");
  ASSERT_TRUE(reader->next(batch, 10));
  EXPECT_EQ(batch, (std::vector<Vec3>{{4, 5, 6}}));
}

TEST_F(ReadPoints, OnAPipeArrivedPointsComeBeforeTheNextIsAwaited) {
  Fifo fifo(path_);
  fifo.write("x y z\n1 2 3\n4 5 6\n7 8");
  const auto reader = open_points(path_);
  std::vector<Vec3> batch;
  ASSERT_TRUE(reader->next(batch, 1000));
  EXPECT_EQ(batch, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_TRUE(reader->would_block());  // half a line is not a point

  fifo.write(" 9\n# remark\n");
  EXPECT_FALSE(reader->would_block());
  ASSERT_TRUE(reader->next(batch, 1000));
  EXPECT_EQ(batch, (std::vector<Vec3>{{7, 8, 9}}));
  EXPECT_TRUE(reader->would_block());  // nor is a comment

  fifo.write("0 0 1");
  EXPECT_TRUE(reader->would_block());
  fifo.close();
  EXPECT_FALSE(reader->would_block());  // the end of the input ends the line
  ASSERT_TRUE(reader->next(batch, 1000));
  EXPECT_EQ(batch, (std::vector<Vec3>{{0, 0, 1}}));
  EXPECT_FALSE(reader->next(batch, 1000));
}

TEST_F(ReadPoints, FullBatchLeavesTheRestForTheNext) {
  Fifo fifo(path_);
  fifo.write("1 1 1\n2 2 2\n3 3 3\n");
  const auto reader = open_points(path_);
  std::vector<Vec3> batch;
  ASSERT_TRUE(reader->next(batch, 2));
  EXPECT_EQ(batch.size(), 2u);
  EXPECT_FALSE(reader->would_block());
  ASSERT_TRUE(reader->next(batch, 2));
  EXPECT_EQ(batch, (std::vector<Vec3>{{3, 3, 3}}));
  EXPECT_TRUE(reader->would_block());
}

// --- NPY ------------------------------------------------------------------------------------------------------------

std::string npy(const std::string& type, const std::string& order, const std::string& shape, const std::string& data,
                char version = 1) {
  const std::string header = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }\n";
  std::string length;
  for (int i = 0; i < (version == 1 ? 2 : 4); ++i) length += static_cast<char>(header.size() >> (8 * i) & 0xFF);
  return std::string("\x93NUMPY") + version + '\0' + length + header + data;
}

const std::vector<Vec3> kWhole{{1, 2, 3}, {4, 5, 6}};

template <class Number>
std::string whole_numbers(bool big_endian = false) {
  return bytes_of<Number>({1, 2, 3, 4, 5, 6}, big_endian);
}

TEST_F(ReadPoints, NpyOfEveryTypeAndByteOrderGivesTheSamePoints) {
  EXPECT_EQ(read(npy("<f8", "False", "(2, 3)", whole_numbers<double>())), kWhole);
  EXPECT_EQ(read(npy(">f8", "False", "(2, 3)", whole_numbers<double>(true))), kWhole);
  EXPECT_EQ(read(npy("<f4", "False", "(2, 3)", whole_numbers<float>(), 2)), kWhole);
  EXPECT_EQ(read(npy(">f4", "False", "(2, 3)", whole_numbers<float>(true), 3)), kWhole);
  EXPECT_EQ(read(npy("|i1", "False", "(2, 3)", whole_numbers<std::int8_t>())), kWhole);
  EXPECT_EQ(read(npy("|u1", "False", "(2, 3)", whole_numbers<std::uint8_t>())), kWhole);
  EXPECT_EQ(read(npy(">i2", "False", "(2, 3)", whole_numbers<std::int16_t>(true))), kWhole);
  EXPECT_EQ(read(npy("<u2", "False", "(2, 3)", whole_numbers<std::uint16_t>())), kWhole);
  EXPECT_EQ(read(npy("<i4", "False", "(2, 3)", whole_numbers<std::int32_t>())), kWhole);
  EXPECT_EQ(read(npy(">u4", "False", "(2, 3)", whole_numbers<std::uint32_t>(true))), kWhole);
  EXPECT_EQ(read(npy("<i8", "False", "(2, 3)", whole_numbers<std::int64_t>())), kWhole);
  EXPECT_EQ(read(npy(">u8", "False", "(2L, 3L)", whole_numbers<std::uint64_t>(true))), kWhole);
}

TEST_F(ReadPoints, NpyOfHalfPrecisionIsExact) {
  // 1, -2, 65504 (largest), 2^-24 (smallest), 1/3 rounded, -0
  const std::string data = bytes_of<std::uint16_t>({0x3C00, 0xC000, 0x7BFF, 0x0001, 0x3555, 0x8000});
  EXPECT_EQ(read(npy("<f2", "False", "(2, 3)", data)),
            (std::vector<Vec3>{{1, -2, 65504}, {0x1p-24, 0.333251953125, 0}}));
}

TEST_F(ReadPoints, NpyInFortranOrderHasItsColumnsOneAfterTheOther) {
  EXPECT_EQ(read(npy("<f8", "True", "(2, 3)", bytes_of<double>({1, 4, 2, 5, 3, 6}))), kWhole);
}

TEST_F(ReadPoints, NpyColumnsBeyondThreeAreIgnored) {
  EXPECT_EQ(read(npy("<i4", "False", "(2, 4)", bytes_of<std::int32_t>({1, 2, 3, 9, 4, 5, 6, 9}))), kWhole);
  EXPECT_EQ(read(npy("<i4", "True", "(2, 4)", bytes_of<std::int32_t>({1, 4, 2, 5, 3, 6, 9, 9}))), kWhole);
}

TEST_F(ReadPoints, NpyAnnouncesItsSizeAndComesInBatches) {
  std::vector<double> numbers(3 * 100000);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<double>(i);
  for (const char* order : {"False", "True"}) {
    const auto reader = open(npy("<f8", order, "(100000, 3)", bytes_of(numbers)));
    EXPECT_EQ(reader->size(), 100000u);
    EXPECT_FALSE(reader->would_block());
    const std::vector<Vec3> points = read_all(*reader, 777);
    ASSERT_EQ(points.size(), 100000u);
    const bool c_order = std::string(order) == "False";
    EXPECT_EQ(points[99999], c_order ? (Vec3{299997, 299998, 299999}) : (Vec3{99999, 199999, 299999}));
  }
}

TEST_F(ReadPoints, NpyThatIsNotPointsIsAnError) {
  const std::string data = whole_numbers<double>();
  EXPECT_EQ(error_of(npy("<f8", "False", "( 6,)", data)), "pts: NPY shape ( 6,), expected (n, 3 or more)");
  EXPECT_EQ(error_of(npy("<f8", "False", "(6,)", data)), "pts: NPY shape (6,), expected (n, 3 or more)");
  EXPECT_EQ(error_of(npy("<f8", "False", "(3, 2)", data)), "pts: NPY shape (3, 2), expected (n, 3 or more)");
  EXPECT_EQ(error_of(npy("<f8", "False", "(1, 2, 3)", data)), "pts: NPY shape (1, 2, 3), expected (n, 3 or more)");
  EXPECT_EQ(error_of(npy("<c16", "False", "(2, 3)", data)),
            "pts: NPY file of type <c16, expected real or integer numbers of at most 64 bits");
  EXPECT_EQ(error_of(npy("|b1", "False", "(2, 3)", data)),
            "pts: NPY file of type |b1, expected real or integer numbers of at most 64 bits");
}

TEST_F(ReadPoints, NpySizesAreComparedWithTheFile) {
  const std::string data = whole_numbers<double>();
  EXPECT_EQ(error_of(npy("<f8", "False", "(3, 3)", data)), "pts: NPY data of 48 bytes, expected 3 rows of 24");
  EXPECT_FALSE(error_of(npy("<f8", "True", "(18446744073709551615, 3)", data)).empty());
  EXPECT_FALSE(error_of(npy("<f8", "False", "(1, 18446744073709551615)", data)).empty());
  EXPECT_FALSE(error_of(npy("<f8", "False", "(99999999999999999999, 3)", data)).empty());
}

TEST_F(ReadPoints, NpyValueThatIsNotFiniteIsAnErrorWithItsByte) {
  const std::string file =
      npy("<f8", "False", "(2, 3)", bytes_of<double>({1, 2, 3, 4, std::numeric_limits<double>::infinity(), 6}));
  EXPECT_EQ(error_of(file),
            "pts:byte " + std::to_string(file.size() - 16) + ": row 1 has y = inf, expected a finite number");
  for (const auto& [bits, number] : {std::pair<std::uint16_t, std::string>{0xFC00, "-inf"}, {0x7E00, "nan"}}) {
    const std::string halves = npy("<f2", "False", "(1, 3)", bytes_of<std::uint16_t>({0x3C00, 0x3C00, bits}));
    EXPECT_EQ(error_of(halves), "pts:byte " + std::to_string(halves.size() - 2) + ": row 0 has z = " + number +
                                    ", expected a finite number");
  }
}

TEST_F(ReadPoints, NpyInCOrderStreamsThroughAPipe) {
  Fifo fifo(path_);
  const std::string file = npy("<f8", "False", "(2, 3)", whole_numbers<double>());
  fifo.write(file.substr(0, file.size() - 4));
  const auto reader = open_points(path_);
  std::vector<Vec3> batch;
  ASSERT_TRUE(reader->next(batch, 10));
  EXPECT_EQ(batch, (std::vector<Vec3>{{1, 2, 3}}));
  EXPECT_TRUE(reader->would_block());
  fifo.write(file.substr(file.size() - 4));
  ASSERT_TRUE(reader->next(batch, 10));
  EXPECT_EQ(batch, (std::vector<Vec3>{{4, 5, 6}}));
  EXPECT_FALSE(reader->next(batch, 10));
}

TEST_F(ReadPoints, NpyInFortranOrderOnAPipeIsHeld) {
  Fifo fifo(path_);
  fifo.write(npy("<f8", "True", "(2, 3)", whole_numbers<double>()));
  std::vector<Vec3> batch;
  const auto reader = open_points(path_);
  ASSERT_TRUE(reader->next(batch, 10));
  EXPECT_EQ(batch, (std::vector<Vec3>{{1, 3, 5}, {2, 4, 6}}));
  EXPECT_FALSE(reader->next(batch, 10));
}

TEST_F(ReadPoints, NpyCutShortAnywhereIsAnError) {
  const std::string whole = npy("<f8", "False", "(2, 3)", whole_numbers<double>());
  for (std::size_t size = 6; size < whole.size(); ++size) EXPECT_FALSE(error_of(whole.substr(0, size)).empty()) << size;
}

TEST_F(ReadPoints, FlippedBytesNeverDoMoreThanThrow) {
  const std::string text = "x,y,\"z\"\n1,2,3\n-4.5,1e-3,\"6\"\n# end\n";
  const std::string binary = npy("<f4", "True", "(2, 3)", whole_numbers<float>());
  std::mt19937 random(1);
  int accepted = 0;
  for (int i = 0; i < 200; ++i) {
    for (const std::string& whole : {text, binary}) {
      std::string damaged = whole;
      for (std::size_t k = 0; k < 1 + i % 3u; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
      accepted += error_of(damaged).empty();
    }
  }
  EXPECT_GT(accepted, 0);
}

// --- PLY ------------------------------------------------------------------------------------------------------------

TEST_F(ReadPoints, PlyGivesItsVerticesWhateverTheFileIsCalled) {
  const std::string rest =
      "\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
      "1 2 3\n-4 0.5 6e-3\n";
  for (const char* const begin : {"ply", "ply ", "ply\t", "\xEF\xBB\xBFply", "\xEF\xBB\xBFply \r"}) {
    const auto reader = open(begin + rest);
    EXPECT_EQ(reader->size(), 2u);
    EXPECT_EQ(read_all(*reader, 1), kTwo);
  }
}

}  // namespace
}  // namespace raycone
