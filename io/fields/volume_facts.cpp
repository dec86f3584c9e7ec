#include "io/fields/volume_facts.h"

#include <algorithm>
#include <string_view>

#include "io/fields/read_image_lattice.h"
#include "io/fields/read_npz_lattice.h"
#include "io/files/file_error.h"
#include "io/files/input_buffer.h"
#include "io/files/npy_head.h"
#include "io/files/zip_reader.h"

namespace raycone {
namespace {

// What a file says of how it was made is text of some thousand characters.
constexpr std::size_t kMostText = std::size_t{1} << 20;

// --- NPZ ------------------------------------------------------------------------------------------------------------

constexpr std::string_view kNpy = ".npy";

VolumeFacts npz_facts(const std::string& path) {
  const ZipReader archive(path);
  VolumeFacts facts;
  facts.format = "NPZ";
  const ZipReader::Member* const text = archive.find("raycone.npy");
  for (const ZipReader::Member& member : archive.members()) {
    if (!member.name.ends_with(kNpy)) continue;
    const bool is_text = &member == text && std::max(member.size, member.packed_size) <= kMostText;
    InputBuffer input(archive.name_of(member), is_text ? archive.open_checked(member) : archive.open(member));
    const NpyHead head = read_npy_head(input);
    facts.arrays.push_back({member.name.substr(0, member.name.size() - kNpy.size()), head.type, head.shape});
    if (!is_text) continue;
    while (input.fill()) continue;
    facts.made_json = input.pending();
    input.check_rest();
  }
  if (facts.arrays.empty()) throw InputError(path + ": has no arrays, expected an NPZ archive");
  if (archive.find("origin.npy") != nullptr) set_lattice(facts, path, [&] { return read_npz_lattice(path); });
  return facts;
}

// --- NRRD and NIfTI-1 -----------------------------------------------------------------------------------------------

std::string entry_of(const auto& entries, const std::string& key, const std::string& otherwise) {
  const auto found = entries.find(key);
  return found == entries.end() ? otherwise : found->second;
}

VolumeFacts facts_of(const NrrdHead& head) {
  VolumeFacts facts;
  facts.format = "NRRD";
  facts.arrays.push_back(
      {entry_of(head.pairs, "raycone_field", ""), entry_of(head.fields, "type", ""), nrrd_shape(head)});
  facts.made_json = entry_of(head.pairs, "raycone", "");
  return facts;
}

VolumeFacts facts_of(const NiftiHead& head) {
  const NiftiFacts told = nifti_facts(head);
  VolumeFacts facts;
  facts.format = "NIfTI-1";
  facts.arrays.push_back({"", told.type, told.shape});
  if (!told.description.empty()) facts.made.push_back({"description", told.description});
  return facts;
}

}  // namespace

VolumeFacts read_volume_facts(const std::string& path) {
  if (!is_image(path)) return npz_facts(path);
  const ImageHead head = read_image_head(path);
  VolumeFacts facts = std::visit([](const auto& format) { return facts_of(format); }, head);
  set_lattice(facts, path, [&] { return image_lattice(path, head); });
  return facts;
}

}  // namespace raycone
