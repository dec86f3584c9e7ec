#include "io/fields/field_format.h"

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>

#include "io/files/ascii.h"

namespace raycone {
namespace {

std::span<const FormatTraits> all_formats() {
  using enum FieldFormat;
  using enum NumberStorage;
  using enum FormatTraits::Content;
  static constexpr std::array kFormats{
      FormatTraits{kVdb, "vdb", kGrids, kLattices | kSeveralFields | kVectors | kHalves},
      FormatTraits{kCsv, "csv", kText, kPoints | kLattices | kSeveralFields | kVectors},
      FormatTraits{kNpy, "npy", kArrays, kPoints | kLattices | kVectors | kHalves},
      FormatTraits{kNpz, "npz", kArrays, kPoints | kLattices | kSeveralFields | kVectors | kHalves},
      FormatTraits{kVti, "vti", kArrays, kLattices | kSeveralFields | kVectors},
      FormatTraits{kNrrd, "nrrd", kArrays, kLattices},
      FormatTraits{kNifti, "nii", kArrays, kLattices},
      FormatTraits{kNiftiGz, "nii.gz", kArrays, kLattices},
      FormatTraits{kRawDouble, "", kArrays, kPoints},
      FormatTraits{kRawSingle, "", kArrays, kPoints},
      FormatTraits{kNone, "none", kNothing, 0},
  };
  return kFormats;
}

}  // namespace

const FormatTraits& traits_of(FieldFormat format) {
  const std::span<const FormatTraits> formats = all_formats();
  const auto found = std::ranges::find(formats, format, &FormatTraits::format);
  if (found == formats.end()) throw std::logic_error("a format without traits");
  return *found;
}

std::vector<FieldFormat> formats_that_hold(FormatTraits::Content content) {
  std::vector<FieldFormat> formats;
  for (const FormatTraits& traits : all_formats()) {
    if (traits.holds(content) && !traits.name.empty()) formats.push_back(traits.format);
  }
  return formats;
}

std::vector<std::string> names_of(std::span<const FieldFormat> formats) {
  std::vector<std::string> names;
  for (const FieldFormat format : formats) names.emplace_back(traits_of(format).name);
  return names;
}

std::optional<FieldFormat> field_format_from_name(std::string_view name) {
  if (name.empty()) return std::nullopt;
  const std::span<const FormatTraits> formats = all_formats();
  const auto found =
      std::ranges::find_if(formats, [&](const FormatTraits& known) { return is_word(name, known.name); });
  return found == formats.end() ? std::nullopt : std::optional(found->format);
}

}  // namespace raycone
