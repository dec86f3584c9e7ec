// Values at points without any format.
#include <gtest/gtest.h>

#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/fields/field_writer.h"
#include "tests/support/output_checks.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"

namespace raycone {
namespace {

TEST(WriteRaw, FloatsAreBoundsOfTheErrorStill) {
  const test::TemporaryDirectory directory;
  OutputDescription description;
  description.fields.push_back({"error_bound", "error_bound", "error_bound", FieldKind::kBound, 0.0, ""});
  std::vector<double> w, bounds;
  for (int n = 0; n < 100; ++n) {
    w.push_back(0.01 * n);
    bounds.push_back(1e-16 * (n + 1));
  }
  {
    OutputFile output(directory / "out");
    const auto writer = make_point_writer(FieldFormat::kRawSingle, output, 100, description);
    writer->write(std::vector<Vec3>(100),
                  std::vector<FieldValues>{std::span(std::as_const(w)), std::span(std::as_const(bounds))});
    writer->finish();
  }
  const std::string bytes = test::read_text(directory / "out");
  std::vector<float> stored(200);
  ASSERT_EQ(bytes.size(), stored.size() * sizeof(float));
  std::memcpy(stored.data(), bytes.data(), bytes.size());
  for (std::size_t n = 0; n < 100; ++n) {
    EXPECT_NEAR(static_cast<double>(stored[2 * n]), w[n], 1e-7);
    EXPECT_GE(static_cast<double>(stored[2 * n + 1]), bounds[n]);
    EXPECT_LE(static_cast<double>(stored[2 * n + 1]), 1.000001 * bounds[n]);
  }
}

}  // namespace
}  // namespace raycone
