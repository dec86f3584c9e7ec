// What the tests of writers share: errors, diagnostics, slabs, and checks by other programs' readers.
#pragma once

#include <gtest/gtest.h>

#include <span>
#include <string>
#include <vector>

#include "core/data/lattice_slabs.h"
#include "io/fields/field_writer.h"
#include "io/files/file_error.h"
#include "tests/support/error_text.h"
#include "tests/support/run_command.h"

namespace raycone::test {

// What the OutputError of `action` says; fails where there is none.
template <typename Action>
std::string output_error_of(const Action& action) {
  const std::string text = error_text<OutputError>(action);
  EXPECT_NE(text, "") << "no OutputError";
  return text;
}

// A value and its diagnostics, as the application describes them.
inline OutputDescription described_with_diagnostics() {
  OutputDescription description;
  description.fields.push_back({"crossings", "crossings", "crossings", FieldKind::kCount, 0.0, ""});
  description.fields.push_back({"degenerate", "degenerate", "degenerate", FieldKind::kCount, 0.0, ""});
  description.fields.push_back({"on_surface", "on_surface", "on_surface", FieldKind::kFlag, 0.0, ""});
  description.fields.push_back({"error_bound", "error_bound", "error_bound", FieldKind::kBound, 0.0, ""});
  return description;
}

// Diagnostics of four samples, each unlike the others.
struct FourDiagnostics {
  std::vector<std::int64_t> crossings{0, -3, 9007199254740993, 1};
  std::vector<std::int64_t> degenerate{0, 2, 1, 0};
  std::vector<std::uint8_t> on_surface{0, 1, 0, 0};
  std::vector<double> error_bound{5e-324, 0.1, 0, 1e-16};

  // `values` and the diagnostics of as many samples from `first` on.
  [[nodiscard]] std::vector<FieldValues> from(std::size_t first, std::span<const double> values) const {
    const auto part = [&](const auto& numbers) { return std::span(numbers).subspan(first, values.size()); };
    return {values, part(crossings), part(degenerate), part(on_surface), part(error_bound)};
  }
};

// The values (x fastest) of the part of the lattice that `block` is.
template <typename Value>
std::vector<Value> part(const Lattice& lattice, const std::vector<Value>& values, const LatticeBlock& block) {
  std::vector<Value> result;
  for_each_sample(block, [&](const LatticeIndex& index) { result.push_back(values[whole(lattice).number_of(index)]); });
  return result;
}

// Runs a program under Debian's Python, which has pyopenvdb, and returns what it said on standard error.
inline std::string run_python(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> command{"/usr/bin/python3", "-c", program};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const CommandResult result = Command(command).wait();
  return result.status == 0 ? result.err : "failed: " + result.err;
}

inline bool python_has(const std::string& module) { return run_python("import " + module, {}).empty(); }

// Writes `values` (x fastest) as a file would be written by the application, in slabs of `thickness`.
inline void write_in_slabs(FieldFormat format, OutputFile& output, const Lattice& lattice,
                           const OutputDescription& description, const std::vector<double>& values,
                           std::int64_t thickness, const FieldTotals& totals = {}) {
  const auto writer = make_lattice_writer(format, output, lattice, description);
  const auto axis = static_cast<std::size_t>(writer->slab_axis());
  for (std::int64_t done = 0; done < lattice.counts[axis]; done += thickness) {
    const LatticeBlock slab = slab_of(whole(lattice), axis, done, thickness);
    const std::vector<double> in_slab = part(lattice, values, slab);
    const FieldValues field = std::span(in_slab);
    writer->write(slab, {&field, 1});
  }
  writer->finish(totals);
}

}  // namespace raycone::test
