// The table of glTF members that geometry needs, and what holds a document against it. tinygltf, which makes numbers of
// the document, drops, cuts or wraps without a word what it does not expect: a mesh with silently missing parts.
#include "io/mesh/gltf_document.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "io/files/ascii.h"
#include "io/files/file_error.h"
#include "io/mesh/bounded_json.h"

namespace raycone {
namespace {

using Json = nlohmann::json;

// Nodes, meshes, primitives, accessors and so on: with tinygltf each takes up to a kilobyte, even one of the text "{}".
constexpr std::uint64_t kMaxParts = std::uint64_t{1} << 21;
constexpr const char* kRootPlace = "document";

// --- The table ------------------------------------------------------------------------------------------------------

enum Kind {
  kObject,    // its members have rows of their own
  kCount,     // a non-negative integer up to `limit`
  kIndex,     // an index into the root's array of things called `name`
  kNumber,    // any; an array holds `limit` of them where one is set
  kText,      // a string
  kName,      // likewise; anything else is no name
  kFlag,      // true or false
  kPresence,  // anything
};
enum Presence { kOptional, kRequired };

constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kInt = std::numeric_limits<int>::max();  // tinygltf's type

struct Row {
  const char* path;  // "[]": the member is an array, the row is about its elements
  Kind kind;
  const char* name = "";  // in messages
  Presence presence = kOptional;
  std::uint64_t limit = kAny;
};

constexpr Row kRows[]{
    {"asset", kObject},
    {"asset.version", kText},
    {"asset.minVersion", kText},
    {"extensionsUsed[]", kText},
    {"extensionsRequired[]", kText},
    {"buffers[]", kObject, "buffer"},
    {"buffers[].uri", kText},
    {"buffers[].byteLength", kCount, "", kRequired},
    {"buffers[].extensions.EXT_meshopt_compression.fallback", kFlag},
    {"buffers[].extensions.KHR_meshopt_compression.fallback", kFlag},
    {"bufferViews[]", kObject, "bufferView"},
    {"bufferViews[].buffer", kIndex, "buffer", kRequired},
    {"bufferViews[].byteOffset", kCount},
    {"bufferViews[].byteLength", kCount, "", kRequired},
    {"bufferViews[].byteStride", kCount},
    {"accessors[]", kObject, "accessor"},
    {"accessors[].bufferView", kIndex, "bufferView"},
    {"accessors[].byteOffset", kCount},
    {"accessors[].componentType", kCount, "", kRequired},
    {"accessors[].normalized", kFlag},
    {"accessors[].count", kCount, "", kRequired},
    {"accessors[].type", kText},
    {"accessors[].sparse.count", kCount, "", kRequired},
    {"accessors[].sparse.indices", kObject, "", kRequired},
    {"accessors[].sparse.indices.bufferView", kIndex, "bufferView", kRequired},
    {"accessors[].sparse.indices.byteOffset", kCount},
    {"accessors[].sparse.indices.componentType", kCount, "", kRequired, kInt},
    {"accessors[].sparse.values", kObject, "", kRequired},
    {"accessors[].sparse.values.bufferView", kIndex, "bufferView", kRequired},
    {"accessors[].sparse.values.byteOffset", kCount},
    {"meshes[]", kObject, "mesh"},
    {"meshes[].name", kName},
    {"meshes[].weights[]", kNumber},
    {"meshes[].primitives[]", kObject, "primitive"},
    {"meshes[].primitives[].attributes", kObject, "", kRequired},
    {"meshes[].primitives[].attributes.POSITION", kIndex, "accessor"},
    {"meshes[].primitives[].indices", kIndex, "accessor"},
    {"meshes[].primitives[].mode", kCount, "", kOptional, 6},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.bufferView", kIndex, "bufferView"},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.attributes.POSITION", kCount, "", kOptional, kInt},
    {"nodes[]", kObject, "node"},
    {"nodes[].matrix[]", kNumber, "", kOptional, 16},
    {"nodes[].translation[]", kNumber, "", kOptional, 3},
    {"nodes[].rotation[]", kNumber, "", kOptional, 4},
    {"nodes[].scale[]", kNumber, "", kOptional, 3},
    {"nodes[].children[]", kIndex, "node"},
    {"nodes[].mesh", kIndex, "mesh"},
    {"nodes[].skin", kPresence},
    {"nodes[].weights[]", kNumber},
    {"nodes[].extensions.KHR_node_visibility.visible", kFlag},
    {"nodes[].extensions.EXT_mesh_gpu_instancing", kObject},
    {"scenes[]", kObject, "scene"},
    {"scenes[].nodes[]", kIndex, "node"},
    {"scene", kIndex, "scene"},
};

// The rows as a tree. Objects that no row is about are optional ones.
struct Member {
  std::string key;
  bool is_array = false;
  Row row{"", kObject};
  std::vector<Member> members = {};
};

Member& member_of(Member& parent, std::string key) {
  const bool is_array = key.ends_with("[]");
  if (is_array) key.resize(key.size() - 2);
  const auto known = std::find_if(parent.members.begin(), parent.members.end(),
                                  [&](const Member& member) { return member.key == key; });
  return known != parent.members.end() ? *known : parent.members.emplace_back(Member{key, is_array});
}

const Member& root_member() {
  static const Member root = [] {
    Member tree;
    for (const Row& row : kRows) {
      Member* at = &tree;
      std::istringstream path(row.path);
      path.exceptions(std::ios_base::badbit);  // lest it take a lack of memory for its end
      for (std::string key; std::getline(path, key, '.');) at = &member_of(*at, key);
      at->row = row;
    }
    return tree;
  }();
  return root;
}

// What else a document holds (images, materials, animations, application data) is not even kept.
bool is_wanted(std::size_t depth, std::string_view key) {
  if (depth > 1) return key != "extras";
  const std::vector<Member>& members = root_member().members;
  return std::any_of(members.begin(), members.end(), [&](const Member& member) { return member.key == key; });
}

// --- Checks ---------------------------------------------------------------------------------------------------------

// Holds a document against the table and takes out of it what the table does not name.
class Checker {
 public:
  Checker(const std::string& file, const Json& root) : file_(file) {
    for (const Member& member : root_member().members) {
      if (member.is_array && root.contains(member.key)) counts_[member.row.name] = root[member.key].size();
    }
  }

  void check_object(Json& json, const Member& object, const std::string& place) {
    if (!json.is_object()) throw InputError(file_ + ": " + place + " is not an object");
    Json kept = Json::object();
    for (const Member& member : object.members) {
      const auto found = json.find(member.key);
      if (found != json.end()) {
        check(*found, member, place);
        kept[member.key] = std::move(*found);
      } else if (member.row.presence == kRequired) {
        fail(place, member,
             member.row.kind == kObject ? " is missing" : " is missing, expected a non-negative integer");
      }
    }
    json = std::move(kept);
  }

 private:
  [[noreturn]] void fail(const std::string& place, const Member& member, const std::string& what) const {
    throw InputError(file_ + ": " + place + ": " + member.key + what);
  }

  [[noreturn]] void fail_expecting(const std::string& expected, const Json& value, const Member& member,
                                   const std::string& place) const {
    fail(place, member,
         (member.is_array ? " holds " : " is ") + excerpt(value.dump(-1, ' ', true)) + ", expected " + expected);
  }

  void check(Json& value, const Member& member, const std::string& place) {
    if (!member.is_array && member.row.kind == kObject) return check_object(value, member, place + ", " + member.key);
    if (!member.is_array) return check_scalar(value, member, place);
    if (!value.is_array()) fail(place, member, " is not an array");
    if (member.row.kind == kObject) return check_objects(value, member, place);
    for (Json& element : value) check_scalar(element, member, place);
    if (member.row.kind == kNumber && member.row.limit != kAny && value.size() != member.row.limit) {
      fail(place, member,
           " has " + std::to_string(value.size()) + " numbers, expected " + std::to_string(member.row.limit));
    }
  }

  void check_objects(Json& value, const Member& member, const std::string& place) {
    if ((parts_ += value.size()) > kMaxParts) {
      throw LimitError(file_ + ": more than " + std::to_string(kMaxParts) + " nodes, meshes and other parts");
    }
    const std::string prefix = (place == kRootPlace ? "" : place + ", ") + member.row.name + " ";
    std::size_t i = 0;
    for (Json& element : value) check_object(element, member, prefix + std::to_string(i++));
  }

  void check_scalar(Json& value, const Member& member, const std::string& place) const {
    const Kind kind = member.row.kind;
    if (kind == kCount || kind == kIndex) return check_integer(value, member, place);
    if (kind == kNumber && !value.is_number()) fail_expecting("a number", value, member, place);
    if (kind == kText && !value.is_string()) fail_expecting("a string", value, member, place);
    if (kind == kFlag && !value.is_boolean()) fail_expecting("true or false", value, member, place);
    if (kind == kName && !value.is_string()) value = "";
    if (kind == kPresence) value = 0;
  }

  // Leaves an unsigned integer.
  void check_integer(Json& value, const Member& member, const std::string& place) const {
    // Some writers print integers as 3.0; beyond 2^53 such a number would not be one integer.
    if (value.is_number_float()) {
      const double number = value.get<double>();
      if (number >= 0.0 && number <= 0x1p53 && std::floor(number) == number) value = static_cast<std::uint64_t>(number);
    }
    if (!value.is_number_unsigned()) fail_expecting("a non-negative integer", value, member, place);
    const auto number = value.get<std::uint64_t>();
    const auto& [path, kind, name, presence, limit] = member.row;
    if (kind == kCount && number > limit) {
      fail(place, member, " " + std::to_string(number) + ", expected 0 to " + std::to_string(limit));
    }
    const std::size_t count = counts_.contains(name) ? counts_.at(name) : 0;
    if (kind == kIndex && number >= count) {
      fail(place, member,
           std::string(" refers to ") + name + " " + std::to_string(number) + ", but there are only " +
               std::to_string(count));
    }
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
    throw InputError(file + ": document: " + name + " " + excerpt(text) + ", expected glTF 2.0");
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

// Moves the numbers that tinygltf would cut to 32 bits.
GltfSparse take_sparse(Json& sparse) {
  const auto take = [](Json& object, const char* key) { return std::exchange(object[key], 0).get<std::uint64_t>(); };
  const auto offset = [&](Json& object) { return object.contains("byteOffset") ? take(object, "byteOffset") : 0; };
  return {take(sparse, "count"), offset(sparse["indices"]), offset(sparse["values"])};
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
  for (Json& accessor : root["accessors"]) {
    replace_unknown_types(accessor);
    document.sparse.push_back(accessor.contains("sparse") ? take_sparse(accessor["sparse"]) : GltfSparse{});
  }
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
  UnwindingReserve reserve;
  Json root = parse_bounded_json(text, is_wanted, reserve);
  if (!root.is_object()) throw InputError(text.file + ": " + kRootPlace + " is not an object");
  Checker checker(text.file, root);
  Json asset = root.value("asset", Json::object());
  checker.check_object(asset, root_member().members.front(), "document, asset");
  check_version(asset, text.file);
  checker.check_object(root, root_member(), kRootPlace);
  return adapted(std::move(root));
}

}  // namespace raycone
