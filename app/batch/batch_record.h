// A row of the results and what it was made from: whether it still holds is told from here.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/batch/file_stamp.h"
#include "app/batch/result_row.h"
#include "app/text/csv.h"

namespace raycone {

struct RowOrigin {
  FileStamp stamp;                     // of the mesh, before it was read
  std::vector<StampedFile> buffers{};  // that it refers to, relative to its directory
  std::vector<OutputStamp> written{};  // of all files that were written, the output first
  std::string version{};               // of raycone
  std::string options{};               // those that results depend on, with the hash of a grid
  std::uint64_t memory_limit = 0;      // bytes
  bool default_memory_limit = false;
  double timeout = 0.0;       // seconds
  std::int64_t finished = 0;  // nanoseconds since 1970: of two rows of a mesh the later one counts
  bool superseded = false;    // begun again since: the output may be another one
  std::string thumbnail{};    // BMP in base64; empty where there is none
  std::string path{};         // of the mesh, from the root: tells later whether it is gone
};

struct BatchRecord {
  ResultRow row;
  std::optional<RowOrigin> origin;  // absent where lost
  std::int64_t finished_by = 0;     // nanoseconds since 1970: at the latest, where the origin is lost
};

// By mesh.
using BatchRecords = std::map<std::string, BatchRecord>;

// When it was finished, at the latest: nanoseconds since 1970.
[[nodiscard]] std::int64_t finished(const BatchRecord& record);

// Keeps, of `record` and the one that `records` may have of the same mesh, the one that was finished last.
void keep_latest(BatchRecord record, BatchRecords& records);

// The names of the columns of the files that keep the origins.
[[nodiscard]] const CsvRecord& origin_columns();
// Those of earlier versions, whose origins say too little to be trusted.
[[nodiscard]] std::vector<CsvRecord> former_origin_columns();

// A note that `mesh` was begun at `time` (nanoseconds since 1970): whatever rows there are from before, in this file or
// that of another shard, its output need not be theirs any more.
[[nodiscard]] CsvRecord to_start_record(const std::string& mesh, std::int64_t time);
// Its time; nothing where `record` is no such note.
[[nodiscard]] std::optional<std::int64_t> start_from(const CsvRecord& record);

// The origin of the row whose CSV line is `line`.
[[nodiscard]] CsvRecord to_record(const RowOrigin& origin, const std::string& mesh, const std::string& line);
// Whether `record` is about a row with this CSV line, of which it keeps a hash; and the origin in it.
[[nodiscard]] bool is_about(const CsvRecord& record, const std::string& line);
[[nodiscard]] std::optional<RowOrigin> origin_from(const CsvRecord& record);

}  // namespace raycone
