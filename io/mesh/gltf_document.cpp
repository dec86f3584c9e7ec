// Parsing of glTF's JSON. nlohmann/json does the syntax; what the document means is checked here, strictly, because a
// value that is silently dropped, cut or wrapped is a mesh with silently missing parts (docs/formats.md tells why
// tinygltf was not used).
#include "io/mesh/gltf_document.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "io/files/file_error.h"

namespace raycone {
namespace {

using Json = nlohmann::json;

// Deeper than any exporter writes, and far from what a stack would notice.
constexpr std::size_t kMaxDepth = 256;
// Objects and arrays: a parsed one takes up to a hundred times the memory of its text "{}".
constexpr std::uint64_t kMaxContainers = 5'000'000;
constexpr std::size_t kMaxQuoted = 120;
constexpr const char* kRoot = "document";

// A JSON object of the document and what to call it in messages: "accessor 3".
class Object {
 public:
  Object(const std::string& file, Json& json, std::string place) : file_(file), json_(json), place_(std::move(place)) {
    if (!json_.is_object()) throw InputError(file_ + ": " + place_ + " is not an object");
  }

  [[noreturn]] void fail(const std::string& what) const { throw InputError(file_ + ": " + place_ + ": " + what); }

  [[nodiscard]] Json* find(const char* key) const {
    const auto member = json_.find(key);
    return member == json_.end() ? nullptr : &*member;
  }

  [[nodiscard]] std::optional<std::uint64_t> integer(const char* key) const {
    const Json* value = find(key);
    if (!value) return std::nullopt;
    return non_negative(*value, key);
  }

  [[nodiscard]] std::uint64_t required_integer(const char* key) const {
    const auto value = integer(key);
    if (!value) fail(std::string(key) + " is missing, expected a non-negative integer");
    return *value;
  }

  // An index into an array of `count` things called `what`.
  [[nodiscard]] std::optional<std::size_t> reference(const char* key, const char* what, std::size_t count) const {
    const auto value = integer(key);
    if (!value) return std::nullopt;
    return in_range(*value, key, what, count);
  }

  [[nodiscard]] std::size_t required_reference(const char* key, const char* what, std::size_t count) const {
    return in_range(required_integer(key), key, what, count);
  }

  [[nodiscard]] std::vector<std::size_t> references(const char* key, const char* what, std::size_t count) const {
    std::vector<std::size_t> indices;
    for (const Json& element : array(key)) {
      indices.push_back(in_range(non_negative(element, key), key, what, count));
    }
    return indices;
  }

  [[nodiscard]] bool flag(const char* key, bool otherwise = false) const {
    const Json* value = find(key);
    if (value && !value->is_boolean()) fail(std::string(key) + " is not true or false");
    return value ? value->get<bool>() : otherwise;
  }

  // Takes the text out of the document: data URIs are large.
  [[nodiscard]] std::optional<std::string> take_text(const char* key) const {
    Json* value = find(key);
    if (!value) return std::nullopt;
    if (!value->is_string()) fail(std::string(key) + " is not a string");
    return std::move(value->get_ref<std::string&>());
  }

  [[nodiscard]] std::vector<double> numbers(const char* key) const {
    std::vector<double> values;
    for (const Json& element : array(key)) {
      if (!element.is_number()) fail(std::string(key) + " holds something that is not a number");
      values.push_back(element.get<double>());
    }
    return values;
  }

  [[nodiscard]] std::vector<std::string> texts(const char* key) const {
    std::vector<std::string> values;
    for (const Json& element : array(key)) {
      if (!element.is_string()) fail(std::string(key) + " holds something that is not a string");
      values.push_back(element.get<std::string>());
    }
    return values;
  }

  // The elements of an array; none where it is missing.
  [[nodiscard]] std::span<Json> array(const char* key) const {
    Json* value = find(key);
    if (!value) return {};
    if (!value->is_array()) fail(std::string(key) + " is not an array");
    return value->get_ref<Json::array_t&>();
  }

  [[nodiscard]] std::optional<Object> object(const char* key) const {
    Json* value = find(key);
    if (!value) return std::nullopt;
    return Object(file_, *value, place_ + ", " + key);
  }

  [[nodiscard]] Object required_object(const char* key) const {
    auto value = object(key);
    if (!value) fail(std::string(key) + " is missing");
    return *std::move(value);
  }

  // The object of extension `name`, if there.
  [[nodiscard]] std::optional<Object> extension(const char* name) const {
    const auto extensions = object("extensions");
    return extensions ? extensions->object(name) : std::nullopt;
  }

  // Calls visit(Object) for each element of the array `key`, called `what` in messages, and frees the array.
  template <class Visit>
  void consume(const char* key, const char* what, Visit visit) const {
    const std::span<Json> elements = array(key);
    const std::string prefix = place_ == kRoot ? std::string(what) + " " : place_ + ", " + what + " ";
    for (std::size_t i = 0; i < elements.size(); ++i) visit(Object(file_, elements[i], prefix + std::to_string(i)));
    if (!elements.empty()) *find(key) = nullptr;
  }

 private:
  [[nodiscard]] std::uint64_t non_negative(const Json& value, const char* key) const {
    if (value.is_number_unsigned()) return value.get<std::uint64_t>();
    // Some writers print integers as 3.0; beyond 2^53 such a number would not be one integer.
    if (value.is_number_float()) {
      const double number = value.get<double>();
      if (number >= 0.0 && number <= 0x1p53 && std::floor(number) == number) return static_cast<std::uint64_t>(number);
    }
    fail(std::string(key) + " is " + value.dump(-1, ' ', true).substr(0, kMaxQuoted) +
         ", expected a non-negative integer");
  }

  [[nodiscard]] std::size_t in_range(std::uint64_t index, const char* key, const char* what, std::size_t count) const {
    if (index >= count) {
      fail(std::string(key) + " refers to " + what + " " + std::to_string(index) + ", but there are only " +
           std::to_string(count));
    }
    return static_cast<std::size_t>(index);
  }

  const std::string& file_;
  Json& json_;
  std::string place_;
};

// --- Syntax ---------------------------------------------------------------------------------------------------------

// What is kept of a document: the arrays that geometry needs. The rest (images, materials, animations, application
// data) costs no memory and cannot fail.
bool is_kept(std::size_t depth, std::string_view key) {
  static constexpr std::array<std::string_view, 10> kKept{
      "accessors",      "asset",  "bufferViews", "buffers", "extensionsRequired",
      "extensionsUsed", "meshes", "nodes",       "scene",   "scenes"};
  if (depth == 1) return std::find(kKept.begin(), kKept.end(), key) != kKept.end();
  return key != "extras";
}

// The place of byte `offset` of the JSON text: a line, or a byte of the GLB.
std::string place_of(const GltfText& text, std::size_t offset) {
  if (text.glb_offset) return "byte " + std::to_string(*text.glb_offset + offset);
  const auto end = text.json.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text.json.size()));
  return std::to_string(1 + std::count(text.json.begin(), end, '\n'));
}

std::string short_and_printable(std::string text) {
  if (text.size() > kMaxQuoted) text = text.substr(0, kMaxQuoted) + "...";
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

// The library's message without its own prefix and place.
std::string reason_of(const std::string& message) {
  std::string reason = message;
  for (const std::string_view prefix : {"] ", ": syntax error "}) {
    const std::size_t found = reason.find(prefix);
    if (found != std::string::npos) reason = reason.substr(found + prefix.size());
  }
  return short_and_printable(reason);
}

// Builds the kept part of the document as the parser meets it. The library's own filter, a callback, takes time
// quadratic in the length of an array.
class DocumentBuilder : public nlohmann::json_sax<Json> {
 public:
  explicit DocumentBuilder(const GltfText& text) : text_(text) {}

  [[nodiscard]] Json take() { return std::move(document_); }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(std::int64_t value) override { return add(value); }
  bool number_unsigned(std::uint64_t value) override { return add(value); }
  bool number_float(double value, const std::string&) override { return add(value); }
  bool string(std::string& value) override { return add(std::move(value)); }
  bool binary(Json::binary_t&) override { return false; }  // does not occur in text
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_array() override { return close(); }

  bool key(std::string& key) override {
    if (skipping()) return true;
    if (is_kept(open_.size(), key)) {
      // Which of the two is meant, nobody can tell.
      if (open_.back()->contains(key)) {
        throw InputError(text_.file + ": JSON with two members '" + short_and_printable(key) +
                         "' in one object, expected one");
      }
      member_ = &(*open_.back())[std::move(key)];
    } else {
      skipped_from_ = open_.size();
    }
    return true;
  }

  bool parse_error(std::size_t offset, const std::string&, const nlohmann::detail::exception& error) override {
    throw InputError(text_.file + ":" + place_of(text_, offset) + ": " + reason_of(error.what()) +
                     ", expected a glTF document");
  }

 private:
  [[nodiscard]] bool skipping() const { return skipped_from_ != 0; }

  // Puts a value where the parser is; the result is valid until the next value of the same array.
  Json* put(Json value) {
    if (open_.empty()) return &(document_ = std::move(value));
    Json& container = *open_.back();
    if (container.is_object()) return &(*member_ = std::move(value));
    return &container.get_ref<Json::array_t&>().emplace_back(std::move(value));
  }

  bool add(Json value) {
    if (!skipping()) put(std::move(value));
    end_skipping();
    return true;
  }

  bool open(Json container) {
    if (open_.size() == kMaxDepth) {
      throw InputError(text_.file + ": JSON is nested deeper than " + std::to_string(kMaxDepth) + " levels");
    }
    if (++containers_ > kMaxContainers) {
      throw LimitError(text_.file + ": JSON of more than " + std::to_string(kMaxContainers) + " objects and arrays");
    }
    open_.push_back(skipping() ? nullptr : put(std::move(container)));
    return true;
  }

  bool close() {
    open_.pop_back();
    end_skipping();
    return true;
  }

  // After a value: back at the depth of the key that started it, skipping ends.
  void end_skipping() {
    if (skipped_from_ == open_.size()) skipped_from_ = 0;
  }

  const GltfText& text_;
  Json document_;
  std::vector<Json*> open_;       // containers the parser is in; nullptr for skipped ones
  Json* member_ = nullptr;        // of the innermost object, named by the last key
  std::size_t skipped_from_ = 0;  // number of open containers at a skipped key; 0: nothing is being skipped
  std::uint64_t containers_ = 0;
};

Json parse_json(const GltfText& text) {
  DocumentBuilder builder(text);
  Json::sax_parse(text.json.begin(), text.json.end(), &builder);
  return builder.take();
}

// --- Meaning --------------------------------------------------------------------------------------------------------

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
void check_version(const Object& root) {
  const auto asset = root.object("asset");
  const auto text = asset ? asset->take_text("version") : std::nullopt;
  if (!text) root.fail("asset version is missing, expected glTF 2.0");
  const auto version = parse_version(*text);
  if (!version || version->first != 2) root.fail("version " + short_and_printable(*text) + ", expected glTF 2.0");
  const auto least_text = asset->take_text("minVersion");
  if (!least_text) return;
  const auto least = parse_version(*least_text);
  if (!least || *least > std::pair(2U, 0U))
    root.fail("minVersion " + short_and_printable(*least_text) + ", expected glTF 2.0");
}

GltfBuffer parse_buffer(const Object& json) {
  GltfBuffer buffer;
  buffer.uri = json.take_text("uri");
  buffer.byte_length = json.required_integer("byteLength");
  for (const char* compression : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const auto extension = json.extension(compression);
    if (extension && extension->flag("fallback")) buffer.fallback_of = compression;
  }
  return buffer;
}

GltfBufferView parse_view(const Object& json, const GltfDocument& document) {
  GltfBufferView view;
  view.buffer = json.required_reference("buffer", "buffer", document.buffers.size());
  view.byte_offset = json.integer("byteOffset").value_or(0);
  view.byte_length = json.required_integer("byteLength");
  view.byte_stride = json.integer("byteStride").value_or(0);
  return view;
}

GltfSparse parse_sparse(const Object& json, const GltfDocument& document) {
  GltfSparse sparse;
  sparse.count = json.required_integer("count");
  const Object indices = json.required_object("indices");
  sparse.indices_view = indices.required_reference("bufferView", "bufferView", document.views.size());
  sparse.indices_offset = indices.integer("byteOffset").value_or(0);
  sparse.indices_type = indices.required_integer("componentType");
  const Object values = json.required_object("values");
  sparse.values_view = values.required_reference("bufferView", "bufferView", document.views.size());
  sparse.values_offset = values.integer("byteOffset").value_or(0);
  return sparse;
}

GltfAccessor parse_accessor(const Object& json, const GltfDocument& document) {
  GltfAccessor accessor;
  accessor.view = json.reference("bufferView", "bufferView", document.views.size());
  accessor.byte_offset = json.integer("byteOffset").value_or(0);
  accessor.component_type = json.required_integer("componentType");
  accessor.normalized = json.flag("normalized");
  accessor.count = json.required_integer("count");
  accessor.type = json.take_text("type").value_or("");
  if (const auto sparse = json.object("sparse")) accessor.sparse = parse_sparse(*sparse, document);
  return accessor;
}

GltfPrimitive parse_primitive(const Object& json, const GltfDocument& document) {
  const std::size_t accessors = document.accessors.size();
  GltfPrimitive primitive;
  primitive.positions = json.required_object("attributes").reference("POSITION", "accessor", accessors);
  primitive.indices = json.reference("indices", "accessor", accessors);
  primitive.mode = json.integer("mode").value_or(4);
  if (primitive.mode > 6) json.fail("mode " + std::to_string(primitive.mode) + ", expected 0 to 6");
  primitive.draco = json.extension("KHR_draco_mesh_compression").has_value();
  return primitive;
}

bool has_weights(const Object& json) {
  const std::vector<double> weights = json.numbers("weights");
  return std::any_of(weights.begin(), weights.end(), [](double weight) { return weight != 0.0; });
}

GltfMesh parse_mesh(const Object& json, const GltfDocument& document) {
  GltfMesh mesh;
  mesh.morphed = has_weights(json);
  json.consume("primitives", "primitive",
               [&](const Object& primitive) { mesh.primitives.push_back(parse_primitive(primitive, document)); });
  return mesh;
}

// The numbers of member `key`, `defaults` where it is missing.
template <std::size_t N>
std::array<double, N> numbers_or(const Object& json, const char* key, std::array<double, N> defaults) {
  if (!json.find(key)) return defaults;
  const std::vector<double> values = json.numbers(key);
  if (values.size() != N) {
    json.fail(std::string(key) + " has " + std::to_string(values.size()) + " numbers, expected " + std::to_string(N));
  }
  std::copy(values.begin(), values.end(), defaults.begin());
  return defaults;
}

// Scaled to entries of at most 1, so that the product of three tiny ones keeps its sign.
bool has_negative_determinant(const GltfTransform& transform) {
  auto r = transform.rows;
  double largest = 0.0;
  for (const auto& row : r) largest = std::max({largest, std::abs(row[0]), std::abs(row[1]), std::abs(row[2])});
  if (largest == 0.0) return false;
  for (auto& row : r) {
    for (double& entry : row) entry /= largest;
  }
  const double determinant = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) +
                             r[0][1] * (r[1][2] * r[2][0] - r[1][0] * r[2][2]) +
                             r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
  return determinant < 0.0;
}

GltfTransform transform_of_matrix(const Object& json) {
  const auto m = numbers_or<16>(json, "matrix", {});  // column after column
  // Rounding of exporters is tolerated in the last row; a projection is not an affine map.
  constexpr double kTolerance = 1e-5;
  if (std::abs(m[3]) > kTolerance || std::abs(m[7]) > kTolerance || std::abs(m[11]) > kTolerance ||
      std::abs(m[15] - 1.0) > kTolerance) {
    json.fail("matrix is not affine, expected 0 0 0 1 in its last row");
  }
  GltfTransform transform;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) transform.rows[row][column] = m[4 * column + row];
  }
  transform.mirrored = has_negative_determinant(transform);
  return transform;
}

GltfTransform transform_of_parts(const Object& json) {
  const auto t = numbers_or<3>(json, "translation", {0, 0, 0});
  const auto q = numbers_or<4>(json, "rotation", {0, 0, 0, 1});
  const auto s = numbers_or<3>(json, "scale", {1, 1, 1});
  const auto [x, y, z, w] = q;
  // Written in decimals, the quaternion is a unit one up to rounding only: dividing by its squared norm normalizes it.
  const double norm = x * x + y * y + z * z + w * w;
  if (!(norm > 0.0) || !std::isfinite(norm)) json.fail("rotation is not a unit quaternion");
  const double f = 2.0 / norm;
  const std::array<std::array<double, 3>, 3> rotation{
      {{1.0 - f * (y * y + z * z), f * (x * y - z * w), f * (x * z + y * w)},
       {f * (x * y + z * w), 1.0 - f * (x * x + z * z), f * (y * z - x * w)},
       {f * (x * z - y * w), f * (y * z + x * w), 1.0 - f * (x * x + y * y)}}};
  GltfTransform transform;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) transform.rows[row][column] = rotation[row][column] * s[column];
    transform.rows[row][3] = t[row];
  }
  transform.mirrored = (s[0] < 0.0) != ((s[1] < 0.0) != (s[2] < 0.0));
  return transform;
}

bool has_transform(const Object& json) {
  return json.find("matrix") || json.find("translation") || json.find("rotation") || json.find("scale");
}

GltfNode parse_node(const Object& json, GltfDocument& document, std::size_t node_count) {
  GltfNode node;
  if (has_transform(json)) {
    node.transform = document.transforms.size();
    document.transforms.push_back(json.find("matrix") ? transform_of_matrix(json) : transform_of_parts(json));
  }
  node.children = json.references("children", "node", node_count);
  node.mesh = json.reference("mesh", "mesh", document.meshes.size());
  node.skinned = json.find("skin") != nullptr;
  node.morphed = has_weights(json);
  const auto visibility = json.extension("KHR_node_visibility");
  node.visible = !visibility || visibility->flag("visible", true);
  return node;
}

}  // namespace

GltfDocument parse_gltf_document(const GltfText& text) {
  Json json = parse_json(text);
  const Object root(text.file, json, kRoot);
  check_version(root);

  GltfDocument document;
  document.extensions_used = root.texts("extensionsUsed");
  document.extensions_required = root.texts("extensionsRequired");
  root.consume("buffers", "buffer", [&](const Object& o) { document.buffers.push_back(parse_buffer(o)); });
  root.consume("bufferViews", "bufferView",
               [&](const Object& o) { document.views.push_back(parse_view(o, document)); });
  root.consume("accessors", "accessor",
               [&](const Object& o) { document.accessors.push_back(parse_accessor(o, document)); });
  root.consume("meshes", "mesh", [&](const Object& o) { document.meshes.push_back(parse_mesh(o, document)); });
  const std::size_t node_count = root.array("nodes").size();
  document.nodes.reserve(node_count);
  root.consume("nodes", "node", [&](const Object& o) {
    document.nodes.push_back(parse_node(o, document, node_count));
    document.gpu_instancing |= o.extension("EXT_mesh_gpu_instancing").has_value();
  });
  root.consume("scenes", "scene",
               [&](const Object& o) { document.scenes.push_back(o.references("nodes", "node", node_count)); });
  document.scene = root.reference("scene", "scene", document.scenes.size());
  return document;
}

}  // namespace raycone
