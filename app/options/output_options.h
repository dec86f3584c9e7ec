// Where results go, and how they are written.
#pragma once

#include <optional>
#include <string>

#include "io/fields/field_writer.h"
#include "io/files/output_file.h"

namespace raycone {

struct OutputFiles {
  std::string path;  // "-": standard output
  Existing existing = Existing::kReplaced;
  std::optional<std::string> report;
  std::optional<std::string> depfile;
};

// How the values of fields are stored.
struct FieldEncoding {
  FieldFormat format = FieldFormat::kCsv;
  std::optional<Precision> precision;    // of real numbers; else what the format does
  bool pack_bits = false;                // of inside
  bool compress = false;                 // NRRD and NIfTI
  std::optional<std::string> grid_name;  // of the only field's grid
};

}  // namespace raycone
