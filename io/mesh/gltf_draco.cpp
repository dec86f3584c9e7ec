// A stream of a few bytes may claim billions of faces and attributes, and Draco allocates what it claims. Its decoders
// are therefore stopped where the counts are known and nothing is allocated yet.
#include "io/mesh/gltf_draco.h"

#include <draco/compression/decode.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>

#include <algorithm>
#include <memory>
#include <type_traits>
#include <utility>

#include "io/files/counted.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// What one stream may make the decoder keep. A unit stands for about twelve bytes.
class Allowance {
 public:
  explicit Allowance(std::size_t bytes) : limit_(std::max(std::uint64_t{1} << 25, 64 * std::uint64_t{bytes})) {}

  // Whether `count` things of so many units each are within it.
  bool spend(std::uint64_t count, std::uint64_t units) {
    exceeded_ = exceeded_ || count > (limit_ - spent_) / units;
    if (!exceeded_) spent_ += count * units;
    return !exceeded_;
  }
  [[nodiscard]] bool exceeded() const { return exceeded_; }

 private:
  std::uint64_t limit_;
  std::uint64_t spent_ = 0;
  bool exceeded_ = false;
};

// A decoder that looks at the counts first.
template <class Decoder>
class Bounded : public Decoder {
 public:
  explicit Bounded(Allowance& allowance) : allowance_(allowance) {}

 protected:
  // The layouts are those of version 2.2.
  bool DecodeConnectivity() override {
    draco::DecoderBuffer ahead = *this->buffer();
    std::uint32_t first = 0, second = 0;
    if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead)) return false;
    std::uint32_t faces = first, points = second;
    std::uint8_t seams = 0;  // attributes with connectivities of their own
    if constexpr (std::is_same_v<Decoder, draco::MeshEdgebreakerDecoder>) {
      std::swap(faces, points);
      if (!ahead.Decode(&seams)) return false;
    }
    return allowance_.spend(faces, 10 + 3 * std::uint64_t{seams}) && allowance_.spend(points, 4) &&
           Decoder::DecodeConnectivity();
  }

  bool DecodeAllAttributes() override {
    const draco::PointCloud& cloud = *this->point_cloud();
    for (std::int32_t i = 0; i < cloud.num_attributes(); ++i) {
      // Each value twice, before and after its quantization is undone, and its index.
      const std::uint64_t components = cloud.attribute(i)->num_components();
      if (!allowance_.spend(cloud.num_points(), 1 + components)) return false;
    }
    return Decoder::DecodeAllAttributes();
  }

 private:
  Allowance& allowance_;
};

[[noreturn]] void fail(const std::string& place, const std::string& what) {
  throw InputError(place + "Draco data " + what);
}

std::unique_ptr<draco::MeshDecoder> decoder_of(std::string_view bytes, Allowance& allowance, const std::string& place) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::DracoHeader header{};
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) fail(place, "have no valid header");
  if (header.version_major != 2 || header.version_minor != 2) {
    fail(place, "are of version " + std::to_string(header.version_major) + "." + std::to_string(header.version_minor) +
                    ", expected 2.2");
  }
  if (header.encoder_type != draco::TRIANGULAR_MESH) fail(place, "are not those of a triangle mesh");
  if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
    return std::make_unique<Bounded<draco::MeshSequentialDecoder>>(allowance);
  }
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING) {
    return std::make_unique<Bounded<draco::MeshEdgebreakerDecoder>>(allowance);
  }
  fail(place, "are of an unknown method");
}

int component_type_of(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
    case draco::DT_UINT8:
    case draco::DT_INT16:
    case draco::DT_UINT16:
      return 5120 + (type - draco::DT_INT8);
    default:
      return type == draco::DT_FLOAT32 ? 5126 : 0;
  }
}

std::vector<Vec3> values_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute, const std::string& place) {
  std::vector<Vec3> values;
  values.reserve(mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(i));
    double numbers[3]{};
    if (value.value() >= attribute.size() || !attribute.ConvertValue<double, 3>(value, numbers)) {
      fail(place, "lack a position of point " + std::to_string(i));
    }
    values.push_back({numbers[0], numbers[1], numbers[2]});
  }
  return values;
}

}  // namespace

DracoMesh decode_draco(std::string_view bytes, int positions, int component_type, const std::string& place) {
  Allowance allowance(bytes.size());
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Mesh mesh;
  const draco::Status status = decoder_of(bytes, allowance, place)->Decode(draco::DecoderOptions(), &buffer, &mesh);
  if (allowance.exceeded()) {
    throw LimitError(place + "Draco data of " + counted(bytes.size(), "byte") + " claim to hold far more");
  }
  if (!status.ok()) fail(place, "cannot be decoded");

  const int id = mesh.GetAttributeIdByUniqueId(static_cast<std::uint32_t>(positions));
  if (id < 0) fail(place, "have no attribute " + std::to_string(positions) + " for the positions");
  draco::PointAttribute* attribute = mesh.attribute(id);
  attribute->set_normalized(false);  // that is for the accessor to say
  if (attribute->num_components() != 3 || component_type_of(attribute->data_type()) != component_type) {
    fail(place, "hold other positions than their accessor, expected the same type");
  }
  DracoMesh result{values_of(mesh, *attribute, place), {}};
  result.corners.reserve(3 * std::size_t{mesh.num_faces()});
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(i))) result.corners.push_back(corner.value());
  }
  return result;
}

}  // namespace raycone
