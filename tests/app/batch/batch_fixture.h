// What the black-box tests of raycone batch share: directories of meshes and outputs, results by mesh.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "app/batch/result_row.h"
#include "app/text/csv.h"
#include "tests/app/meshes.h"
#include "tests/support/environment.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {

class Batch : public testing::Test {
 protected:
  using Rows = std::map<std::string, ResultRow>;

  // A mesh in the directory of meshes.
  std::string put(const std::string& name, const std::string& text = kCube) const {
    const std::filesystem::path path = std::filesystem::path(meshes_) / name;
    std::filesystem::create_directories(path.parent_path());
    write_text(path, text);
    return path.string();
  }

  // Options given twice count as given last. For VDB, the default, each worker would take most of its time to load
  // OpenVDB.
  [[nodiscard]] std::vector<std::string> arguments(const std::vector<std::string>& more = {}) const {
    return arguments_into(out_, more);
  }
  [[nodiscard]] std::vector<std::string> arguments_into(const std::string& out,
                                                        const std::vector<std::string>& more = {}) const {
    return with_more({"batch", meshes_, "--out-dir", out, "--resolution", "8", "--format", "npy"}, more);
  }

  [[nodiscard]] CommandResult run(const std::vector<std::string>& more = {}, const CommandOptions& options = {}) const {
    return run_raycone(arguments(more), options);
  }

  // The rows of a table of results; every line must be one, sorted by mesh.
  [[nodiscard]] static Rows rows_in(const std::string& path) {
    Rows rows;
    const std::string text = read_text(path);
    const CsvText table = parse_csv(text);
    EXPECT_EQ(table.complete, text.size()) << path;
    if (table.records.empty()) return rows;
    EXPECT_EQ(table.records.front(), result_columns());
    std::string last;
    for (std::size_t i = 1; i < table.records.size(); ++i) {
      const std::optional<ResultRow> row = row_from(table.records[i]);
      EXPECT_TRUE(row) << path << ": line " << i;
      if (!row) continue;
      EXPECT_LT(last, row->mesh);
      last = row->mesh;
      rows.emplace(row->mesh, *row);
    }
    return rows;
  }
  [[nodiscard]] Rows rows() const { return rows_in(out_ + "/results.csv"); }

  [[nodiscard]] static std::map<std::string, std::string> statuses(const Rows& rows) {
    std::map<std::string, std::string> result;
    for (const auto& [mesh, row] : rows) result.emplace(mesh, name_of(row.status));
    return result;
  }

  // Everything in `directory` but the files of results: names and contents.
  [[nodiscard]] static std::map<std::string, std::string> outputs_in(const std::string& directory) {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(directory)) {
      const std::string name = entry.path().lexically_relative(directory).string();
      const bool of_results = name.starts_with("results") || name.starts_with("batch-state");
      if (entry.is_regular_file() && !of_results) files.emplace(name, read_text(entry.path().string()));
    }
    return files;
  }

  // Rows without what depends on the moment: times and memory.
  [[nodiscard]] static std::map<std::string, CsvRecord> lasting(const Rows& rows) {
    std::map<std::string, CsvRecord> result;
    for (auto [mesh, row] : rows) {
      if (row.figures) {
        row.figures->read_s = row.figures->prepare_s = row.figures->evaluate_s = row.figures->write_s = 0.0;
        row.figures->peak_memory_bytes = 0;
      }
      result.emplace(mesh, to_record(row));
    }
    return result;
  }

  // Jobs share the memory: of a machine with many cores and little of it each would have too little, unless told so.
  Environment threads_{{{"RAYCONE_THREADS", std::getenv("RAYCONE_THREADS") ? std::getenv("RAYCONE_THREADS") : "2"}}};
  TemporaryDirectory dir_;
  std::string meshes_ = dir_ / "meshes";
  std::string out_ = dir_ / "out";
};

using Statuses = std::map<std::string, std::string>;

}  // namespace raycone::test
