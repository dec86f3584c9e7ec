// The formats of fields, and what each of them can hold.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raycone {

// kNone: nothing is written, for measurements.
enum class FieldFormat {
  kVdb,
  kCsv,
  kNpy,
  kVti,
  kNpz,
  kNrrd,
  kNifti,
  kNiftiGz,    // NIfTI-1, packed by gzip
  kRawDouble,  // nothing but numbers, little-endian; has no name
  kRawSingle,
  kNone,
};

enum class NumberStorage {
  kNothing,
  kText,    // numbers of any size, with all their digits
  kArrays,  // numbers of so many bits, one per sample
  kGrids,   // the same, but for samples where a grid holds nothing
};

struct FormatTraits {
  // What a format may hold, as bits.
  enum Content : unsigned {
    kPoints = 1,
    kLattices = 2,
    // On lattices:
    kSeveralFields = 4,
    kVectors = 8,
    kHalves = 16,  // numbers of 16 bits
  };

  FieldFormat format;
  std::string_view name;  // in small letters; empty where there is none
  NumberStorage storage;
  unsigned contents;

  [[nodiscard]] bool holds(Content content) const { return (contents & content) != 0; }
};

[[nodiscard]] const FormatTraits& traits_of(FieldFormat format);

// Of those with a name, in the order of messages and help.
[[nodiscard]] std::vector<FieldFormat> formats_that_hold(FormatTraits::Content content);
[[nodiscard]] std::vector<std::string> names_of(std::span<const FieldFormat> formats);

// In any case.
[[nodiscard]] std::optional<FieldFormat> field_format_from_name(std::string_view name);

[[nodiscard]] inline bool is_text(FieldFormat format) { return traits_of(format).storage == NumberStorage::kText; }

}  // namespace raycone
