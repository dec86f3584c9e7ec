// Output set aside until its final form is known.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "io/files/output_file.h"

namespace raycone {

// An unlinked temporary file for formats whose head depends on their tail, where the output is a pipe and cannot be
// gone back in. Errors (OutputError) name the output.
class SpoolFile {
 public:
  // `name` of the output that the bytes are for.
  explicit SpoolFile(const std::string& name);
  ~SpoolFile();
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;

  // Seekable. Errors surface in copy_to().
  std::ostream& stream();
  // Appends all bytes to `output`.
  void copy_to(OutputFile& output);
  // Calls take(data, size) for all bytes, piece by piece.
  void read_back(const std::function<void(const char*, std::size_t)>& take);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace raycone
