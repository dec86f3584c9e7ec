// The table of glTF members that geometry needs, and what holds a document against it. tinygltf, which makes numbers of
// the document, drops, cuts or wraps without a word what it does not expect: a mesh with silently missing parts.
#include "io/gltf_document.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/bounded_json.h"
#include "io/file_error.h"

namespace raycone {
namespace {

using Json = nlohmann::json;

// Nodes, scenes, meshes and primitives: tinygltf takes up to 456 bytes for the text "{}".
constexpr std::uint64_t kMaxParts = std::uint64_t{1} << 20;
constexpr std::size_t kMaxQuoted = 120;
constexpr const char* kRootPlace = "document";

// --- The table ------------------------------------------------------------------------------------------------------

enum Kind {
  kCount,     // a non-negative integer up to `limit`
  kIndex,     // an index into the root's array of things called `name`
  kIndices,   // an array of those
  kNumbers,   // an array of numbers, of `limit` of them where one is set
  kText,      // a string
  kTexts,     // an array of strings
  kFlag,      // true or false
  kPresence,  // anything
  kObject,    // an object of `members`
  kObjects,   // an array of those, each called `name` in messages
  kParts,     // the same; kMaxParts counts them
};

constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kInt = std::numeric_limits<int>::max();  // tinygltf's type

struct Member {
  const char* key;
  Kind kind;
  const char* name = "";
  std::uint64_t limit = kAny;
  std::vector<Member> members = {};
  bool required = false;
};
using Members = std::vector<Member>;

Member object(const char* key, Members members) { return {key, kObject, "", kAny, std::move(members)}; }
Member required(Member member) {
  member.required = true;
  return member;
}

Members buffer_members() {
  const Members fallback{{"fallback", kFlag}};
  return {
      {"uri", kText},
      required({"byteLength", kCount}),
      object("extensions", {object("EXT_meshopt_compression", fallback), object("KHR_meshopt_compression", fallback)})};
}

Members accessor_members() {
  const Member view{"bufferView", kIndex, "bufferView"};
  const Member offset{"byteOffset", kCount, "", kInt};
  const Members indices{required(view), offset, required({"componentType", kCount, "", kInt})};
  return {view,
          {"byteOffset", kCount},
          required({"componentType", kCount}),
          {"normalized", kFlag},
          required({"count", kCount}),
          {"type", kText},
          object("sparse", {required({"count", kCount, "", kInt}), required(object("indices", indices)),
                            required(object("values", {required(view), offset}))})};
}

Members mesh_members() {
  const Members draco{{"bufferView", kIndex, "bufferView"}, object("attributes", {{"POSITION", kCount, "", kInt}})};
  const Members primitive{required(object("attributes", {{"POSITION", kIndex, "accessor"}})),
                          {kGltfIndices, kIndex, "accessor"},
                          {"mode", kCount, "", 6},
                          object("extensions", {object(kGltfDraco, draco)})};
  return {{"weights", kNumbers}, {"primitives", kParts, "primitive", kAny, primitive}};
}

Members node_members() {
  return {{"matrix", kNumbers, "", 16},
          {"translation", kNumbers, "", 3},
          {"rotation", kNumbers, "", 4},
          {"scale", kNumbers, "", 3},
          {"children", kIndices, "node"},
          {"mesh", kIndex, "mesh"},
          {"skin", kPresence},
          {"weights", kNumbers},
          object("extensions", {object(kGltfVisibility, {{"visible", kFlag}}), object(kGltfInstancing, {})})};
}

const Members& root_members() {
  static const Members members{object("asset", {{"version", kText}, {"minVersion", kText}}),
                               {"extensionsUsed", kTexts},
                               {"extensionsRequired", kTexts},
                               {"buffers", kObjects, "buffer", kAny, buffer_members()},
                               {"bufferViews",
                                kObjects,
                                "bufferView",
                                kAny,
                                {required({"buffer", kIndex, "buffer"}),
                                 {"byteOffset", kCount},
                                 required({"byteLength", kCount}),
                                 {"byteStride", kCount}}},
                               {"accessors", kObjects, "accessor", kAny, accessor_members()},
                               {"meshes", kParts, "mesh", kAny, mesh_members()},
                               {"nodes", kParts, "node", kAny, node_members()},
                               {"scenes", kParts, "scene", kAny, {{"nodes", kIndices, "node"}}},
                               {"scene", kIndex, "scene"}};
  return members;
}

// What else a document holds (images, materials, animations, application data) is not even kept.
bool is_wanted(std::size_t depth, std::string_view key) {
  if (depth > 1) return key != "extras";
  const Members& root = root_members();
  return std::any_of(root.begin(), root.end(), [&](const Member& member) { return member.key == key; });
}

// --- Checks ---------------------------------------------------------------------------------------------------------

// Holds a document against the table and takes out of it what the table does not name.
class Checker {
 public:
  Checker(const std::string& file, const Json& root) : file_(file) {
    for (const Member& member : root_members()) {
      if (!member.members.empty() && root.contains(member.key)) counts_[member.name] = root[member.key].size();
    }
  }

  void check_object(Json& json, const Members& members, const std::string& place) {
    if (!json.is_object()) throw InputError(file_ + ": " + place + " is not an object");
    Json kept = Json::object();
    for (const Member& member : members) {
      const auto found = json.find(member.key);
      if (found != json.end()) {
        check(*found, member, place);
        kept[member.key] = std::move(*found);
      } else if (member.required) {
        const bool is_object = member.kind == kObject;
        fail(place, member, is_object ? " is missing" : " is missing, expected a non-negative integer");
      }
    }
    json = std::move(kept);
  }

 private:
  [[noreturn]] void fail(const std::string& place, const Member& member, const std::string& what) const {
    throw InputError(file_ + ": " + place + ": " + member.key + what);
  }

  void check(Json& value, const Member& member, const std::string& place) {
    const bool is_array = member.kind == kIndices || member.kind == kNumbers || member.kind == kTexts ||
                          member.kind == kObjects || member.kind == kParts;
    if (is_array && !value.is_array()) fail(place, member, " is not an array");
    if (member.kind == kCount || member.kind == kIndex) check_integer(value, member, place);
    if (member.kind == kText && !value.is_string()) fail(place, member, " is not a string");
    if (member.kind == kFlag && !value.is_boolean()) fail(place, member, " is not true or false");
    if (member.kind == kPresence) value = 0;
    if (member.kind == kObject) check_object(value, member.members, place + ", " + member.key);
    if (is_array) check_elements(value, member, place);
  }

  void check_elements(Json& value, const Member& member, const std::string& place) {
    if (member.kind == kParts && (parts_ += value.size()) > kMaxParts) {
      throw LimitError(file_ + ": more than " + std::to_string(kMaxParts) + " nodes, scenes, meshes and primitives");
    }
    const std::string prefix = (place == kRootPlace ? "" : place + ", ") + member.name + " ";
    std::size_t i = 0;
    for (Json& element : value) {
      if (member.kind == kIndices) check_integer(element, member, place);
      if (member.kind == kNumbers && !element.is_number()) {
        fail(place, member, " holds something that is not a number");
      }
      if (member.kind == kTexts && !element.is_string()) fail(place, member, " holds something that is not a string");
      if (!member.members.empty()) check_object(element, member.members, prefix + std::to_string(i++));
    }
    if (member.kind == kNumbers && member.limit != kAny && value.size() != member.limit) {
      fail(place, member,
           " has " + std::to_string(value.size()) + " numbers, expected " + std::to_string(member.limit));
    }
  }

  // Leaves an unsigned integer.
  void check_integer(Json& value, const Member& member, const std::string& place) const {
    // Some writers print integers as 3.0; beyond 2^53 such a number would not be one integer.
    if (value.is_number_float()) {
      const double number = value.get<double>();
      if (number >= 0.0 && number <= 0x1p53 && std::floor(number) == number) value = static_cast<std::uint64_t>(number);
    }
    const std::string text = value.is_number_unsigned() ? "" : value.dump(-1, ' ', true).substr(0, kMaxQuoted);
    if (!value.is_number_unsigned()) fail(place, member, " is " + text + ", expected a non-negative integer");
    const auto number = value.get<std::uint64_t>();
    if (member.kind == kCount) {
      if (number <= member.limit) return;
      fail(place, member, " " + std::to_string(number) + ", expected 0 to " + std::to_string(member.limit));
    }
    const std::size_t count = counts_.contains(member.name) ? counts_.at(member.name) : 0;
    if (number < count) return;
    fail(place, member,
         std::string(" refers to ") + member.name + " " + std::to_string(number) + ", but there are only " +
             std::to_string(count));
  }

  const std::string& file_;
  std::map<std::string, std::size_t, std::less<>> counts_;  // of the elements of the root's arrays, by `name`
  std::uint64_t parts_ = 0;
};

// A version "2.0" as the pair (2, 0); absent where it is none.
std::optional<std::pair<unsigned, unsigned>> parse_version(std::string_view text) {
  std::pair<unsigned, unsigned> version;
  const char* end = text.data() + text.size();
  const auto major = std::from_chars(text.data(), end, version.first);
  if (major.ec != std::errc() || major.ptr == end || *major.ptr != '.') return std::nullopt;
  const auto minor = std::from_chars(major.ptr + 1, end, version.second);
  return minor.ec == std::errc() && minor.ptr == end ? std::optional(version) : std::nullopt;
}

// Later versions 2.x may be read, unless the asset says that it takes one.
void check_version(const Json& asset, const std::string& file) {
  const auto check = [&](const char* key, const std::string& name, auto is_good) {
    const std::string text = asset[key].get<std::string>();
    const auto version = parse_version(text);
    if (version && is_good(*version)) return;
    throw InputError(file + ": document: " + name + " " + short_and_printable(text) + ", expected glTF 2.0");
  };
  if (!asset.contains("version")) throw InputError(file + ": document: asset version is missing, expected glTF 2.0");
  check("version", "version", [](const auto& version) { return version.first == 2; });
  if (!asset.contains("minVersion")) return;
  check("minVersion", "minVersion", [](const auto& version) { return version <= std::pair(2U, 0U); });
}

// --- For tinygltf ---------------------------------------------------------------------------------------------------

GltfBuffer take_buffer(Json& json) {
  GltfBuffer buffer;
  if (json.contains("uri")) buffer.uri = std::move(json["uri"].get_ref<std::string&>());
  buffer.byte_length = json["byteLength"].get<std::uint64_t>();
  for (const auto& [name, extension] : json["extensions"].items()) {
    if (extension.value("fallback", false)) buffer.fallback_of = name;
  }
  return buffer;
}

// Unknown types do no harm where no triangle needs the accessor, but tinygltf refuses them.
void replace_unknown_types(Json& accessor) {
  static constexpr std::array<std::string_view, 7> kTypes{"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
  constexpr std::uint64_t kByte = 5120, kFloat = 5126, kDouble = 5130;
  if (std::find(kTypes.begin(), kTypes.end(), accessor.value("type", "")) == kTypes.end()) accessor["type"] = "MAT4";
  const auto type = accessor["componentType"].get<std::uint64_t>();
  if (type < kByte || type > kFloat) accessor["componentType"] = kDouble;
}

// Takes out of a checked document what tinygltf refuses, or would load by its own rules.
GltfDocument adapted(Json root) {
  GltfDocument document;
  for (Json& buffer : root["buffers"]) document.buffers.push_back(take_buffer(buffer));
  root.erase("buffers");
  for (Json& view : root["bufferViews"]) {
    document.strides.push_back(view.value("byteStride", std::uint64_t{0}));
    view.erase("byteStride");
  }
  for (Json& accessor : root["accessors"]) replace_unknown_types(accessor);
  for (Json& mesh : root["meshes"]) {
    for (Json& primitive : mesh["primitives"]) {
      if (!primitive.contains(kGltfIndices)) continue;
      primitive["attributes"][kGltfIndices] = primitive[kGltfIndices];
      primitive.erase(kGltfIndices);
    }
  }
  document.json = root.dump();
  return document;
}

}  // namespace

GltfDocument parse_gltf_document(const JsonText& text) {
  Json root = parse_bounded_json(text, is_wanted);
  if (!root.is_object()) throw InputError(text.file + ": " + kRootPlace + " is not an object");
  Checker checker(text.file, root);
  Json asset = root.value("asset", Json::object());
  checker.check_object(asset, root_members().front().members, "document, asset");
  check_version(asset, text.file);
  checker.check_object(root, root_members(), kRootPlace);
  return adapted(std::move(root));
}

}  // namespace raycone
