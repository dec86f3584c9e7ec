// 3MF: the triangles of what is to be built.
// Format: 3MF Core Specification 1.3; io/mesh/three_mf_model.cpp reads the parts of a package.
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/data/warning.h"
#include "io/files/ascii.h"
#include "io/files/counted.h"
#include "io/files/file_error.h"
#include "io/files/zip_reader.h"
#include "io/mesh/affine_map.h"
#include "io/mesh/append_placed.h"
#include "io/mesh/face_groups.h"
#include "io/mesh/read_mesh.h"
#include "io/mesh/three_mf_model.h"

namespace raycone {
namespace {

// An object with triangles, and where it stands.
struct Instance {
  const ThreeMfObject* object = nullptr;
  AffineMap placement;
};

// What is left out of the result or taken for something else, for warnings.
struct ThreeMfOmissions {
  std::uint64_t lattices = 0;
  std::uint64_t sliced = 0;
  std::uint64_t others = 0;
  std::uint64_t empty = 0;
};

std::vector<Warning> warnings_of(const ThreeMfOmissions& omissions) {
  std::vector<Warning> warnings;
  const auto warn = [&](const char* name, std::uint64_t count, const char* noun, const char* what) {
    if (count > 0) warnings.push_back({name, counted(count, noun) + " " + what});
  };
  warn("beam-lattices", omissions.lattices, "beam lattice", "without triangles ignored");
  warn("slices", omissions.sliced, "object", "with slices, which are ignored: triangles count");
  warn("other-objects", omissions.others, "object", "of the type 'other', as modifiers and holes are, count as solid");
  warn("empty-objects", omissions.empty, "object", "without triangles ignored");
  return warnings;
}

class ThreeMfPackage {
 public:
  explicit ThreeMfPackage(const NamedBytes& source) : file_(source.name), parts_(source.bytes, source.name) {}

  ParsedMesh build() {
    const ThreeMfModel& root = model(std::make_shared<const std::string>(parts_.root()));
    for (const ThreeMfUse& item : root.items) place(item, {}, root.unit);
    std::ranges::stable_sort(instances_, {}, [&](const Instance& i) { return first_use_.at(i.object); });
    for (auto it = instances_.begin(); it != instances_.end(); ++it) {
      if (it == instances_.begin() || it->object != std::prev(it)->object) {
        groups_.start_group(it->object->name, parsed_.mesh.triangles.size());
      }
      const TriangleMesh& mesh = it->object->mesh;
      spend(mesh.vertices.size() + mesh.triangles.size());
      append_placed(mesh, it->placement, file_, parsed_.mesh);
    }
    parsed_.groups = groups_.finish(parsed_.mesh.triangles.size());
    parsed_.unit = root.unit;
    parsed_.warnings = warnings_of(omissions_);
    return std::move(parsed_);
  }

 private:
  const ThreeMfModel& model(const std::shared_ptr<const std::string>& part) {
    const auto [known, is_new] = by_name_.try_emplace(part);
    if (is_new) known->second = &model_of(parts_.find(*part));
    return *known->second;
  }

  const ThreeMfModel& model_of(const ZipReader::Member& member) {
    const auto [known, is_new] = models_.try_emplace(&member);
    if (!is_new) return known->second;
    known->second = parts_.read_model(member);
    for (const auto& [id, object] : known->second.objects) {
      stored_ += object.mesh.vertices.size() + object.mesh.triangles.size();
    }
    return known->second;
  }

  const ThreeMfObject& object(const ThreeMfUse& use) {
    const ThreeMfModel& from = model(use.part);
    const auto found = from.objects.find(use.object);
    if (found != from.objects.end()) return found->second;
    throw InputError(file_ + ": " + excerpt(*use.part) + ": no object " + std::to_string(use.object) +
                     ", which a component or an item of the build names");
  }

  // Coordinates are in the unit of their own part (core specification, 3.4).
  [[nodiscard]] static AffineMap to_unit(const std::string& unit, const std::string& of_part) {
    const double factor = *micrometres_of(of_part) / *micrometres_of(unit);
    return affine_map_of_parts({}, std::array{0.0, 0.0, 0.0, 1.0}, {factor, factor, factor});
  }

  // Notes the object and its components. Deeper than any assembly there may only be a cycle.
  void place(const ThreeMfUse& use, const AffineMap& outer, const std::string& outer_unit) {
    constexpr std::size_t kDeepest = 256;
    constexpr std::size_t kMostUses = std::size_t{1} << 20;  // components of components may multiply without bound
    if (++uses_ > kMostUses) throw LimitError(file_ + ": components make more than 1048576 copies of objects");
    if (depth_ == kDeepest) throw InputError(file_ + ": components within components, more than 256 deep");
    const ThreeMfObject& placed = object(use);
    const std::string& unit = model(use.part).unit;
    const AffineMap in_outer_unit = composed(outer, use.placement);
    const AffineMap placement = unit == outer_unit ? in_outer_unit : composed(in_outer_unit, to_unit(outer_unit, unit));
    if (!placed.stands_for.empty()) {
      throw InputError(file_ + ": object " + std::to_string(use.object) + " has triangles " + placed.stands_for +
                       ", expected its shape in triangles");
    }
    if (!placed.mesh.triangles.empty()) {
      instances_.push_back({&placed, placement});
      first_use_.try_emplace(&placed, first_use_.size());
    } else if (placed.is_sliced && placed.components.empty()) {
      throw InputError(file_ + ": object " + std::to_string(use.object) + " has slices only, expected triangles");
    }
    if (seen_.insert(&placed).second) note_omissions(placed);
    ++depth_;
    for (const ThreeMfUse& component : placed.components) place(component, placement, unit);
    --depth_;
  }

  void note_omissions(const ThreeMfObject& placed) {
    omissions_.lattices += placed.lattices;
    omissions_.sliced += placed.is_sliced;
    omissions_.others += placed.is_other && !placed.mesh.triangles.empty();
    omissions_.empty += placed.mesh.triangles.empty() && placed.components.empty() && placed.lattices == 0;
  }

  // Bounds what a small file may ask for by naming an object many times.
  void spend(std::uint64_t elements) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 26;
    spent_ += elements;
    if (spent_ > kMost && spent_ > 16 * stored_) {
      throw LimitError(file_ + ": copies of objects have more than " + std::to_string(kMost) +
                       " vertices and triangles");
    }
  }

  const std::string& file_;
  ThreeMfParts parts_;
  std::map<const ZipReader::Member*, ThreeMfModel> models_;  // of the parts read so far
  std::map<std::shared_ptr<const std::string>, const ThreeMfModel*> by_name_;
  std::vector<Instance> instances_;
  std::map<const ThreeMfObject*, std::size_t> first_use_;  // the order of objects with triangles
  std::size_t uses_ = 0, depth_ = 0;
  std::set<const ThreeMfObject*> seen_;
  ThreeMfOmissions omissions_;            // of objects that were seen
  std::uint64_t stored_ = 0, spent_ = 0;  // vertices and triangles: of models_, and of copies
  GroupCollector groups_;
  ParsedMesh parsed_;
};

}  // namespace

ParsedMesh read_3mf(const NamedBytes& source) { return ThreeMfPackage(source).build(); }

}  // namespace raycone
