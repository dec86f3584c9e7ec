// One mesh of a batch: what a worker is asked to do, and what it answers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/batch/batch_record.h"
#include "app/batch/message.h"
#include "app/batch/result_row.h"

namespace raycone {

struct Job {
  std::string mesh;    // file to read
  std::string output;  // file to write
  int threads = 1;
  std::uint64_t memory_limit = 0;  // bytes
};

struct JobResult {
  ResultRow row;                        // its `mesh` and `output` are left empty
  std::vector<std::string> warnings;    // about the mesh
  std::vector<StampedFile> companions;  // further files that were read, by their hashes
  std::string thumbnail;                // BMP in base64; empty where there is none
};

[[nodiscard]] Message to_message(const Job& job);
[[nodiscard]] Message to_message(const JobResult& result);
// Throw std::runtime_error for any other message.
[[nodiscard]] Job job_from(const Message& message);
[[nodiscard]] JobResult result_from(const Message& message);

}  // namespace raycone
