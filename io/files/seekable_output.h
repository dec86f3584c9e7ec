// Output that is written in any order.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>

#include "io/files/output_file.h"
#include "io/files/spool_file.h"

namespace raycone {

// The file itself or, where that cannot be gone back in (a pipe), a spool that is copied to it when complete.
class SeekableOutput {
 public:
  // `output` must outlive this.
  explicit SeekableOutput(OutputFile& output);

  // Errors surface in commit().
  std::ostream& stream();
  // May lie behind all that has been written. Throws OutputError.
  void write_at(std::uint64_t offset, const void* data, std::size_t size);
  // Completes and commits the file. Throws OutputError.
  void commit();

 private:
  OutputFile& output_;
  std::optional<SpoolFile> spool_;
};

}  // namespace raycone
