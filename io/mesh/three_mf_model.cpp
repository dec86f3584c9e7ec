// Format: 3MF Core Specification 1.3, Production Extension 1.1.2. Package: ECMA-376 part 2 (Open Packaging
// Conventions).
#include "io/mesh/three_mf_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files/ascii.h"
#include "io/files/enumerated.h"
#include "io/files/file_error.h"
#include "io/files/percent_encoding.h"
#include "io/files/text_scanner.h"
#include "io/mesh/face_groups.h"
#include "io/mesh/mesh_error.h"
#include "io/mesh/xml_reader.h"

namespace raycone {
namespace {

#define RAYCONE_3MF "http://schemas.microsoft.com/3dmanufacturing/"
constexpr std::string_view kCore = RAYCONE_3MF "core/2015/02|";
constexpr std::string_view kProductionPath = RAYCONE_3MF "production/2015/06|path";
constexpr std::string_view kBeamLattice = RAYCONE_3MF "beamlattice/2017/02|beamlattice";
constexpr std::string_view kSliceStack = RAYCONE_3MF "slice/2015/07|slicestackid";
constexpr std::string_view kMeshResolution = RAYCONE_3MF "slice/2015/07|meshresolution";
constexpr std::string_view kModelResolution = RAYCONE_3MF "production/alternatives/2021/04|modelresolution";
constexpr std::string_view kModelRelation = RAYCONE_3MF "2013/01/3dmodel";
constexpr std::string_view kEncrypted = "/encryptedfile", kKeys = "/keystore";  // ends of relations' types
// Required extensions that leave triangles as they are, or that are read.
constexpr std::array<std::string_view, 5> kHarmless{RAYCONE_3MF "material/2015/02", RAYCONE_3MF "production/2015/06",
                                                    RAYCONE_3MF "slice/2015/07", RAYCONE_3MF "trianglesets/2021/07",
                                                    RAYCONE_3MF "core/2015/02"};
#undef RAYCONE_3MF

// The same for all names of a part: relative to the root of the package, in any case of letters (ECMA-376 part 2, 6.2).
std::string key_of(std::string_view name) {
  std::string decoded = percent_decoded(name);
  std::ranges::replace(decoded, '\\', '/');  // of old writers
  return lower_case(std::filesystem::path('/' + decoded).lexically_normal().relative_path().string());
}

struct Unit {
  std::string_view name;
  double micrometres;
};
constexpr std::array<Unit, 6> kUnits{
    {{"micron", 1}, {"millimeter", 1e3}, {"centimeter", 1e4}, {"inch", 25'400}, {"foot", 304'800}, {"meter", 1e6}}};

std::string unit_of(const XmlAttributes& attributes) {
  const std::string_view unit = attributes.find("unit").value_or("millimeter");
  if (micrometres_of(unit)) return std::string(unit);
  std::vector<std::string> names;
  for (const Unit& known : kUnits) names.emplace_back(known.name);
  attributes.fail("unit is '" + excerpt(unit) + "', expected " + enumerated(names, " or "));
}

// "m00 m01 ... m32": the rows of a matrix that row vectors are multiplied by, so that each is where an axis goes.
AffineMap placement_of(const XmlAttributes& attributes) {
  const auto text = attributes.find("transform");
  if (!text) return {};
  std::array<double, 16> matrix{};
  matrix[15] = 1.0;
  std::string_view rest = *text;
  for (std::size_t i = 0; i < 12; ++i) {
    while (!rest.empty() && is_space(rest.front())) rest.remove_prefix(1);
    std::size_t length = 0;
    while (length < rest.size() && !is_space(rest[length])) ++length;
    const auto number = number_of(rest.substr(0, length));
    if (!number || !std::isfinite(*number)) attributes.fail("transform: expected 12 finite numbers");
    matrix[i / 3 * 4 + i % 3] = *number;
    rest.remove_prefix(length);
  }
  if (!rest.empty()) attributes.fail("transform: more than 12 numbers");
  return affine_map_of_matrix(matrix);
}

// The elements of a model part that matter; others are passed over with all that is in them.
class ModelReader {
 public:
  ModelReader(const std::string& part, const std::string& name)
      : part_(std::make_shared<const std::string>(part)), name_(name) {}

  [[nodiscard]] XmlHandler handler() {
    return {[&](std::string_view name, const XmlAttributes& attributes) { start(name, attributes); },
            [&](std::string_view) { end(); },
            [&](std::string_view prefix, std::string_view uri) { prefixes_[std::string(prefix)] = uri; }};
  }
  [[nodiscard]] ThreeMfModel take() { return std::move(model_); }

 private:
  enum class Element {
    kOutside,
    kModel,
    kResources,
    kObject,
    kMesh,
    kVertices,
    kTriangles,
    kComponents,
    kBuild,
    kLeaf
  };

  void start(std::string_view name, const XmlAttributes& attributes) {
    if (passed_over_ > 0) {
      ++passed_over_;
    } else if (const auto element = known(name)) {
      open_.push_back(*element);
      enter(name, attributes);
    } else if (open_.empty()) {
      attributes.fail("element " + excerpt(name) + ", expected " + std::string(kCore) + "model");
    } else {
      if (name == kBeamLattice && object_ != nullptr) ++object_->lattices;
      ++passed_over_;
    }
  }

  void end() {
    if (passed_over_ > 0) {
      --passed_over_;
      return;
    }
    if (open_.back() == Element::kMesh) check_indices();
    if (open_.back() == Element::kObject) object_ = nullptr;
    open_.pop_back();
  }

  // What an element of this name is inside of the one that is open.
  [[nodiscard]] std::optional<Element> known(std::string_view name) const {
    struct Row {
      Element parent;
      std::string_view name;
      Element element;
    };
    static constexpr Row kRows[]{{Element::kOutside, "model", Element::kModel},
                                 {Element::kModel, "resources", Element::kResources},
                                 {Element::kResources, "object", Element::kObject},
                                 {Element::kObject, "mesh", Element::kMesh},
                                 {Element::kMesh, "vertices", Element::kVertices},
                                 {Element::kVertices, "vertex", Element::kLeaf},
                                 {Element::kMesh, "triangles", Element::kTriangles},
                                 {Element::kTriangles, "triangle", Element::kLeaf},
                                 {Element::kObject, "components", Element::kComponents},
                                 {Element::kComponents, "component", Element::kLeaf},
                                 {Element::kModel, "build", Element::kBuild},
                                 {Element::kBuild, "item", Element::kLeaf}};
    if (!name.starts_with(kCore)) return std::nullopt;
    name.remove_prefix(kCore.size());
    const Element parent = open_.empty() ? Element::kOutside : open_.back();
    for (const Row& row : kRows) {
      if (row.parent == parent && row.name == name) return row.element;
    }
    return std::nullopt;
  }

  void enter(std::string_view name, const XmlAttributes& attributes) {
    if (name.ends_with("|vertex")) {
      add_vertex(attributes);
    } else if (name.ends_with("|triangle")) {
      add_triangle(attributes);
    } else if (name.ends_with("|component")) {
      object_->components.push_back(use_of(attributes));
    } else if (name.ends_with("|item")) {
      model_.items.push_back(use_of(attributes));
    } else if (open_.back() == Element::kObject) {
      start_object(attributes);
    } else if (open_.back() == Element::kMesh) {
      if (!object_->mesh.vertices.empty()) attributes.fail("a second mesh of an object, expected one");
    } else if (open_.back() == Element::kModel) {
      check_extensions(attributes);
      model_.unit = unit_of(attributes);
    }
  }

  // Extensions are named by prefixes.
  void check_extensions(const XmlAttributes& attributes) const {
    std::string_view rest = attributes.find("requiredextensions").value_or("");
    while (!rest.empty()) {
      const std::size_t length = std::min(rest.find(' '), rest.size());
      const std::string prefix(rest.substr(0, length));
      rest.remove_prefix(std::min(length + 1, rest.size()));
      if (prefix.empty()) continue;
      const auto uri = prefixes_.find(prefix);
      const std::string& meant = uri == prefixes_.end() ? prefix : uri->second;
      if (std::ranges::count(kHarmless, meant) == 0) {
        attributes.fail("requires the extension " + excerpt(meant) + ", which is not supported");
      }
    }
  }

  void start_object(const XmlAttributes& attributes) {
    const std::uint32_t id = attributes.index("id");
    const auto [object, is_new] = model_.objects.try_emplace(id);
    if (!is_new) attributes.fail("a second object " + std::to_string(id));
    object_ = &object->second;
    object_->name = cut_name(attributes.find("name").value_or(""));
    object_->is_other = attributes.find("type") == "other";
    object_->is_sliced = attributes.find(kSliceStack).has_value();
    if (attributes.find(kMeshResolution) == "lowres") object_->stands_for = "of low resolution beside its slices";
    const std::string_view model = attributes.find(kModelResolution).value_or("fullres");
    if (model != "fullres") object_->stands_for = "that stand for its alternatives (" + excerpt(model) + ")";
  }

  void add_vertex(const XmlAttributes& attributes) {
    if (object_->mesh.vertices.size() == kMaxVertices) fail_too_many_vertices(name_);
    object_->mesh.vertices.push_back({attributes.number("x"), attributes.number("y"), attributes.number("z")});
  }

  void add_triangle(const XmlAttributes& attributes) {
    object_->mesh.triangles.push_back({attributes.index("v1"), attributes.index("v2"), attributes.index("v3")});
  }

  // At the end of a mesh: vertices may stand behind triangles.
  void check_indices() const {
    const std::size_t count = object_->mesh.vertices.size();
    for (const Triangle& triangle : object_->mesh.triangles) {
      for (const std::uint32_t corner : triangle) {
        if (corner >= count) throw InputError(name_ + ": " + index_out_of_range(corner, count));
      }
    }
  }

  [[nodiscard]] std::shared_ptr<const std::string> shared(std::string_view path) {
    auto& name = paths_[std::string(path)];
    if (!name) name = std::make_shared<const std::string>(path);
    return name;
  }

  [[nodiscard]] ThreeMfUse use_of(const XmlAttributes& attributes) {
    const auto path = attributes.find(kProductionPath);
    return {path ? shared(*path) : part_, attributes.index("objectid"), placement_of(attributes)};
  }

  std::shared_ptr<const std::string> part_;
  std::map<std::string, std::shared_ptr<const std::string>> paths_;
  const std::string& name_;  // "FILE(PART)"
  std::map<std::string, std::string> prefixes_;
  std::vector<Element> open_;
  std::size_t passed_over_ = 0;  // open elements that are not known
  ThreeMfModel model_;
  ThreeMfObject* object_ = nullptr;
};

}  // namespace

std::optional<double> micrometres_of(std::string_view unit) {
  const auto* const found = std::ranges::find(kUnits, unit, &Unit::name);
  return found == kUnits.end() ? std::nullopt : std::optional(found->micrometres);
}

// Names of parts do not depend on the case of letters. Of several members of one name the last one counts, as in any
// ZIP archive; names that are equivalent (ECMA-376 part 2, 6.2) may be one part to one reader and another to the next.
ThreeMfParts::ThreeMfParts(std::string_view bytes, const std::string& file)
    : file_(file), size_(bytes.size()), archive_(bytes, file) {
  for (const ZipReader::Member& member : archive_.members()) {
    const auto [part, is_new] = parts_.try_emplace(key_of(member.name), &member);
    if (!is_new && part->second->name != member.name) {
      throw InputError(file_ + ": has the parts " + excerpt(part->second->name) + " and " + excerpt(member.name) +
                       ", expected names that differ by more than case or encoding");
    }
    part->second = &member;
  }
}

std::string ThreeMfParts::root() {
  std::string root;
  const auto note = [&](std::string_view name, const XmlAttributes& attributes) {
    if (!name.ends_with("|Relationship")) return;
    const std::string_view type = attributes.text("Type");
    if (type.ends_with(kEncrypted) || type.ends_with(kKeys)) {
      throw InputError(file_ + ": is encrypted, expected a 3MF that can be read");
    }
    if (type == kModelRelation && root.empty()) root = attributes.text("Target");
  };
  read(find("_rels/.rels"), {note, [](std::string_view) {}, {}});
  if (root.empty()) throw InputError(file_ + ": no 3D model in its relationships, expected a 3MF package");
  return root;
}

const ZipReader::Member& ThreeMfParts::find(const std::string& name) const {
  const auto found = parts_.find(key_of(name));
  if (found != parts_.end()) return *found->second;
  throw InputError(file_ + ": no part " + excerpt(name.starts_with('/') ? name.substr(1) : name) +
                   ", expected a 3MF package");
}

ThreeMfModel ThreeMfParts::read_model(const ZipReader::Member& part) {
  const std::string name = archive_.name_of(part);
  ModelReader reader(part.name, name);
  read(part, reader.handler());
  return reader.take();
}

void ThreeMfParts::read(const ZipReader::Member& part, const XmlHandler& handler) {
  read_ += part.packed_size;
  if (read_ > size_) throw InputError(file_ + ": has parts that share bytes, expected parts of their own");
  read_xml(*archive_.open_checked(part), archive_.name_of(part), handler);
}

}  // namespace raycone
