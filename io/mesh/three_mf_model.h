// The model parts of a 3MF package: objects and what is to be built of them.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "io/files/zip_reader.h"
#include "io/mesh/affine_map.h"
#include "io/mesh/xml_reader.h"

namespace raycone {

// An object that stands somewhere: a component of another, or an item of the build.
struct ThreeMfUse {
  std::shared_ptr<const std::string> part;  // where the object is; few names serve many uses
  std::uint32_t object = 0;
  AffineMap placement;
};

struct ThreeMfObject {
  std::string name;  // may be empty
  TriangleMesh mesh;
  std::vector<ThreeMfUse> components;
  bool is_sliced = false;      // it has slices, which may be all that it has
  bool is_other = false;       // by its type: not to be built by itself
  std::string stands_for;      // what its triangles only stand for, and how; else empty
  std::uint64_t lattices = 0;  // of beams, which are passed over
};

// Of the format's units; absent for other words.
[[nodiscard]] std::optional<double> micrometres_of(std::string_view unit);

struct ThreeMfModel {
  std::string unit;               // known to micrometres_of(): "millimeter" where the part names none
  std::vector<ThreeMfUse> items;  // of the root part, in order
  std::map<std::uint32_t, ThreeMfObject> objects;
};

// The parts of a package. `bytes` and `file` must outlive this; all throw InputError.
class ThreeMfParts {
 public:
  ThreeMfParts(std::string_view bytes, const std::string& file);

  // The name of the root model. Throws where this is no 3MF, and where it is encrypted.
  [[nodiscard]] std::string root();
  // By its name, in any case of letters and with or without percent encoding.
  [[nodiscard]] const ZipReader::Member& find(const std::string& name) const;
  // Throws where the model is invalid, damaged or needs an extension that changes shapes and is not known; and
  // LimitError. All indices of triangles are in range, all coordinates finite.
  [[nodiscard]] ThreeMfModel read_model(const ZipReader::Member& part);

 private:
  void read(const ZipReader::Member& part, const XmlHandler& handler);

  const std::string& file_;
  std::uint64_t size_;      // of the archive
  std::uint64_t read_ = 0;  // of it: parts that share bytes could ask for any amount of work
  ZipReader archive_;
  std::map<std::string, const ZipReader::Member*> parts_;  // by names that are the same for all that are equivalent
};

}  // namespace raycone
