#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/data/lattice_slabs.h"
#include "io/fields/field_writer.h"
#include "io/files/file_error.h"
#include "tests/support/output_checks.h"
#include "tests/support/pipe.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"

namespace raycone {
namespace {

using test::read_text;
using test::TemporaryDirectory;

// Reads the arrays of a file as VTK does: each where the head says, behind its size.
constexpr const char* kReader = R"(
import numpy, re, struct, sys
import xml.etree.ElementTree as tree
data = open(sys.argv[1], 'rb').read()
begin = data.index(b'<AppendedData encoding="raw">')
start = data.index(b'_', begin) + 1
root = tree.fromstring(data[:begin] + b'</VTKFile>')
assert root.attrib == dict(type='ImageData', version='1.0', byte_order='LittleEndian', header_type='UInt64')
image = root[0]
extent = [int(n) for n in image.attrib['WholeExtent'].split()]
shape = [extent[5] - extent[4] + 1, extent[3] - extent[2] + 1, extent[1] - extent[0] + 1]
arrays, end = {}, start
for array in image[0][0]:
    at = start + int(array.attrib['offset'])
    assert at == end
    size, = struct.unpack_from('<Q', data, at)
    values = numpy.frombuffer(data, array.attrib['type'].lower(), offset=at + 8, count=numpy.prod(shape))
    assert values.nbytes == size and array.attrib['format'] == 'appended'
    arrays[array.attrib['Name']] = values.reshape(shape)
    end = at + 8 + size
assert data[end:] == b'\n  </AppendedData>\n</VTKFile>\n', data[end:end + 50]
)";

// A program that reads the file, and then holds `assertions`.
std::string with_reader(const char* assertions) {
  std::string program = kReader;
  return program += assertions;
}

Lattice small_lattice() { return {{0.1, -2, 1e-3}, {0.5, 0.25, 3}, {-3, 5, 7}, {4, 3, 2}}; }

OutputDescription described_with_flags() {
  OutputDescription description = test::described_with_diagnostics();
  description.fields.insert(description.fields.begin() + 1, {"inside", "inside", "inside", FieldKind::kFlag, 0.0, ""});
  return description;
}

void write_vti(const std::string& path, const OutputDescription& description) {
  OutputFile output(path);
  const auto writer = make_lattice_writer(FieldFormat::kVti, output, small_lattice(), description);
  for (int layer = 0; layer < 2; ++layer) {
    std::vector<double> w, bounds(12, 1e-300);
    std::vector<std::uint8_t> inside;
    for (int n = 0; n < 12; ++n) {
      w.push_back(0.1 * (12 * layer + n));
      inside.push_back(n == 3 ? 1 : 0);
    }
    if (layer == 0) w[0] = -0.0;
    const std::vector<std::int64_t> counts(12, 9007199254740993);
    const LatticeBlock slab = slab_of(whole(small_lattice()), 2, layer, 1);
    writer->write(slab, std::vector<FieldValues>{
                            std::span<const double>(w), std::span<const std::uint8_t>(inside), std::span(counts),
                            std::span(counts), std::span<const std::uint8_t>(inside), std::span<const double>(bounds)});
  }
  writer->finish({});
}

TEST(WriteVti, HoldsEveryFieldWithXFastest) {
  if (!test::python_has("numpy")) GTEST_SKIP() << "no numpy in /usr/bin/python3";
  const TemporaryDirectory directory;
  write_vti(directory / "out.vti", described_with_flags());
  EXPECT_EQ(test::run_python(with_reader(R"(
assert extent == [-3, 0, 5, 7, 7, 8]
assert image.attrib['Origin'] == '0.1 -2 0.001' and image.attrib['Spacing'] == '0.5 0.25 3'
assert image[0].attrib['Extent'] == image.attrib['WholeExtent'] and image[0][0].attrib['Scalars'] == 'winding'
assert list(arrays) == ['winding', 'inside', 'crossings', 'degenerate', 'on_surface', 'error_bound']
w = arrays['winding']
assert w.dtype == 'f4' and (w.ravel() == (numpy.arange(24) * 0.1).astype('f4')).all()
assert not numpy.signbit(w[0, 0, 0])
assert arrays['inside'].dtype == 'u1' and arrays['inside'].nonzero()[2].tolist() == [3, 3]
assert (arrays['crossings'] == 9007199254740993).all()
assert arrays['error_bound'].dtype == 'f8' and (arrays['error_bound'] == 1e-300).all()
)"),
                             {directory / "out.vti"}),
            "");
}

TEST(WriteVti, DoublesOnRequest) {
  if (!test::python_has("numpy")) GTEST_SKIP() << "no numpy in /usr/bin/python3";
  const TemporaryDirectory directory;
  OutputDescription description = described_with_flags();
  description.precision = Precision::kDouble;
  write_vti(directory / "out.vti", description);
  EXPECT_EQ(test::run_python(with_reader("assert (arrays['winding'].ravel()[1:] == "
                                         "[0.1 * n for n in range(1, 24)]).all()\n"),
                             {directory / "out.vti"}),
            "");
}

TEST(WriteVti, IsTheSameOnAPipe) {
  const TemporaryDirectory directory;
  write_vti(directory / "out.vti", described_with_flags());
  const auto write = [](const std::string& path) { write_vti(path, described_with_flags()); };
  EXPECT_EQ(test::received_through_pipe(write), read_text(directory / "out.vti"));
}

TEST(WriteVti, RefusesIndicesThatVtkCannotHold) {
  const TemporaryDirectory directory;
  OutputFile output(directory / "out.vti");
  Lattice lattice = small_lattice();
  lattice.index_min[1] = std::int64_t{1} << 31;
  EXPECT_THROW(make_lattice_writer(FieldFormat::kVti, output, lattice, {}), OutputError);
}

}  // namespace
}  // namespace raycone
