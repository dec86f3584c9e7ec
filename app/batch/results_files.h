// The files in which a batch keeps its results. For each batch or shard there are two: results.csv, for users, with a
// row a mesh, and batch-state.csv, which tells what each row was made from. Both are appended to as results come, a
// write(2) a line, and sorted at the end; what a killed writer left of a line is dropped. Synced are the sorted ones: a
// line that a loss of power takes away is made again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/batch/batch_record.h"
#include "app/batch/csv_log.h"
#include "app/options/batch_command.h"

namespace raycone {

// When the evaluation of meshes began: nanoseconds since 1970, by mesh.
using Starts = std::map<std::string, std::int64_t>;

class ResultsFiles {
 public:
  // Those of a shard, or of the whole batch, in `directory`.
  ResultsFiles(const std::string& directory, const std::optional<Shard>& shard);

  [[nodiscard]] BatchRecords read() const;
  // Forgets the rows of `meshes`, and what a killed writer left incomplete. Notes the time at which each is begun: rows
  // of other shards from before are superseded, too, although they are theirs to forget.
  void forget(const Starts& meshes) const;
  void append(const BatchRecord& record) const;
  // Removes the rows of `meshes`, where there are any.
  void remove(const std::set<std::string>& meshes) const;
  // Adds `records` where they are newer than what is there, or its origin is lost, sorts by mesh, and syncs.
  void merge(const BatchRecords& records) const;

 private:
  struct Contents {
    BatchRecords records;
    Starts starts;
  };
  friend BatchRecords read_all_results(const std::string& directory);
  friend std::size_t count_unreadable_rows(const std::string& directory);
  [[nodiscard]] Contents contents() const;
  void write(const Contents& contents) const;

  std::string directory_;
  CsvLog rows_;
  CsvLog origins_;
};

// Of the whole batch and all its shards together. Of a mesh with several rows the one that was finished last counts;
// one whose origin is lost may be from any time until its file changed last. Throws InputError.
[[nodiscard]] BatchRecords read_all_results(const std::string& directory);

// Rows there that are damaged, or cut short: nothing is known of their meshes. Throws InputError.
[[nodiscard]] std::size_t count_unreadable_rows(const std::string& directory);

// Tells the user of them, where there are any. Throws InputError.
void warn_of_unreadable_rows(const std::string& directory);

// Where there are tables of shards, but none of the whole batch: which shards have none, a line of text for each number
// of shards that a batch was divided into: "no results of shards 2, 3 and 5 of 5". A shard of no meshes has a table.
// Throws InputError.
[[nodiscard]] std::vector<std::string> missing_shards(const std::string& directory);

// Removes from the whole batch and all its shards the rows of meshes that are gone. Not while a shard runs: a row that
// it adds at this moment would be lost, and made again. Throws InputError, OutputError.
void remove_from_all_results(const std::string& directory, const std::set<std::string>& meshes);

// Of the files in a directory; none where it is not there, or a file. Throws InputError where it cannot be read.
[[nodiscard]] std::vector<std::string> names_in(const std::string& directory);

// Whether a batch keeps its results in files of this name, or its rows.
[[nodiscard]] bool is_results_file(const std::string& name);
[[nodiscard]] bool holds_rows(const std::string& name);

}  // namespace raycone
