// Output set aside until its final form is known.
#pragma once

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

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace raycone
