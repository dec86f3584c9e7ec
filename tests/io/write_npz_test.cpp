// ZIP archives, and the arrays of NumPy in them.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "io/fields/field_writer.h"
#include "io/files/zip_writer.h"
#include "tests/support/output_checks.h"
#include "tests/support/pipe.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"

namespace raycone {
namespace {

using test::read_text;
using test::TemporaryDirectory;

std::string zip_of(const std::string& first, const std::string& second, std::uint64_t zip64_from) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.zip");
  ZipWriter zip(output, {{"first.txt", first.size()}, {"second.txt", second.size()}}, zip64_from);
  for (const std::size_t begin : {std::size_t{0}, first.size() / 2}) {  // by turns
    zip.append(0, &first[begin], begin == 0 ? first.size() / 2 : first.size() - begin);
    if (begin == 0) zip.append(1, second.data(), second.size());
  }
  zip.finish();
  return read_text(directory / "out.zip");
}

TEST(ZipWriter, PythonReadsArchivesOfBothForms) {
  if (!test::python_has("zipfile")) GTEST_SKIP() << "no /usr/bin/python3";
  const TemporaryDirectory directory;
  const std::string first(100, 'x'), second = "hello";
  for (const std::uint64_t zip64_from : {ZipWriter::kLargest32, std::uint64_t{50}, std::uint64_t{0}}) {
    const std::string zip = zip_of(first, second, zip64_from);
    std::ofstream(directory / "out.zip", std::ios::binary) << zip;
    EXPECT_EQ(zip.find("PK\x06\x06") != std::string::npos, zip64_from != ZipWriter::kLargest32);
    EXPECT_EQ(test::run_python("import sys, zipfile\n"
                               "archive = zipfile.ZipFile(sys.argv[1])\n"
                               "assert archive.testzip() is None\n"
                               "assert archive.namelist() == ['first.txt', 'second.txt']\n"
                               "assert archive.read('first.txt') == b'x' * 100\n"
                               "assert archive.read('second.txt') == b'hello'\n",
                               {directory / "out.zip"}),
              "")
        << zip64_from;
  }
}

TEST(ZipWriter, MembersMustBeAsLongAsAnnounced) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.zip");
  ZipWriter zip(output, {{"a", 3}});
  zip.append(0, "ab", 2);
  EXPECT_THROW(zip.finish(), std::logic_error);
}

OutputDescription described() {
  OutputDescription description = test::described_with_diagnostics();
  description.fields.push_back({"inside", "inside", "inside", FieldKind::kFlag, 0.0, ""});
  return description;
}

// Seven points in two batches.
void write_npz(const std::string& path) {
  OutputFile output(path);
  const auto writer = make_point_writer(FieldFormat::kNpz, output, 7, described());
  for (const int count : {4, 3}) {
    const auto n = static_cast<std::size_t>(count);
    const double first = count == 4 ? 0.0 : 4.0;
    std::vector<Vec3> points;
    std::vector<double> w;
    for (std::size_t i = 0; i < n; ++i) {
      points.push_back({first + static_cast<double>(i), 0.5, -1});
      w.push_back(0.25 * static_cast<double>(i));
    }
    const std::vector<std::int64_t> crossings(n, -7), degenerate(n, 3);
    const std::vector<std::uint8_t> on_surface(n, 1), inside(n, 0);
    const std::vector<double> bounds(n, 1e-15);
    writer->write(points,
                  std::vector<FieldValues>{std::span(std::as_const(w)), std::span(crossings), std::span(degenerate),
                                           std::span(on_surface), std::span(bounds), std::span(inside)});
  }
  writer->finish();
}

TEST(WriteNpz, NumpyLoadsPointsAndFields) {
  if (!test::python_has("numpy")) GTEST_SKIP() << "no numpy in /usr/bin/python3";
  const TemporaryDirectory directory;
  write_npz(directory / "out.npz");
  EXPECT_EQ(test::run_python("import numpy, sys\n"
                             "z = numpy.load(sys.argv[1])\n"
                             "assert z.files == ['points', 'w', 'crossings', 'degenerate', 'on_surface', 'error_bound',"
                             " 'inside', 'transform'], z.files\n"
                             "assert z['points'].shape == (7, 3) and z['points'].dtype == 'f8'\n"
                             "assert (z['points'] == [[n, 0.5, -1] for n in range(7)]).all()\n"
                             "assert z['w'].tolist() == [0, .25, .5, .75, 0, .25, .5]\n"
                             "assert z['crossings'].dtype == 'i8' and z['crossings'].tolist() == [-7] * 7\n"
                             "assert z['degenerate'].dtype == 'i8' and z['degenerate'].tolist() == [3] * 7\n"
                             "assert z['on_surface'].dtype == bool and z['on_surface'].all()\n"
                             "assert z['inside'].dtype == bool and not z['inside'].any() and len(z['inside']) == 7\n"
                             "assert z['error_bound'].tolist() == [1e-15] * 7\n",
                             {directory / "out.npz"}),
            "");
}

TEST(WriteNpz, IsTheSameOnAPipe) {
  const TemporaryDirectory directory;
  write_npz(directory / "out.npz");
  EXPECT_EQ(test::received_through_pipe(write_npz), read_text(directory / "out.npz"));
}

}  // namespace
}  // namespace raycone
