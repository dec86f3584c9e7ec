// Bytes packed as a gzip file (RFC 1952) while they are written.
#pragma once

#include <cstddef>
#include <memory>

#include "io/files/output_file.h"

namespace raycone {

// The head has neither name nor time, so that equal bytes make equal files.
class GzipWriter {
 public:
  // Appends to `output`, which must outlive this. Throws std::bad_alloc.
  explicit GzipWriter(OutputFile& output);
  ~GzipWriter();
  GzipWriter(const GzipWriter&) = delete;
  GzipWriter& operator=(const GzipWriter&) = delete;

  // Throws OutputError.
  void write(const void* data, std::size_t size);
  // Writes the end; does not commit. Throws OutputError.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace raycone
