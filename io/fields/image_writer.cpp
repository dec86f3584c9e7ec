#include "io/fields/image_writer.h"

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>

#include "io/fields/array_elements.h"
#include "io/files/gzip_writer.h"

namespace raycone {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as they are in memory");

class ImageWriter final : public LatticeWriter {
 public:
  ImageWriter(OutputFile& output, const OutputDescription& description, const std::string& head, Packed packed)
      : output_(output),
        elements_(make_array_elements(description.fields.front(), description.precision.value_or(Precision::kSingle),
                                      output.name())) {
    const bool packs_head = description.compress && packed == Packed::kFile;
    if (!packs_head) output_.write(head.data(), head.size());
    if (description.compress) packed_.emplace(output_);
    if (packs_head) append({head.data(), head.size()});
  }

  int slab_axis() const override { return 2; }
  std::int64_t slab_alignment() const override { return 1; }
  void write(const LatticeBlock&, std::span<const FieldValues> fields) override {
    append(elements_->in_order(fields.front()));
  }
  void finish(const FieldTotals&) override {
    if (packed_) packed_->finish();
    output_.commit();
  }

 private:
  void append(std::span<const char> bytes) {
    if (packed_) return packed_->write(bytes.data(), bytes.size());
    output_.write(bytes.data(), bytes.size());
  }

  OutputFile& output_;
  std::unique_ptr<ArrayElements> elements_;
  std::optional<GzipWriter> packed_;
};

}  // namespace

ImageElement image_element(const OutputDescription& description) {
  if (description.fields.front().kind == FieldKind::kFlag) return ImageElement::kByte;
  if (description.fields.front().kind == FieldKind::kLabel) return ImageElement::kInteger;
  return description.is(Precision::kDouble) ? ImageElement::kDouble : ImageElement::kFloat;
}

Vec3 first_sample(const PlacedLattice& lattice) {
  const auto [i, j, k] = lattice.grid.index_min;
  return lattice.position(i, j, k);
}

std::unique_ptr<LatticeWriter> make_image_writer(OutputFile& output, const OutputDescription& description,
                                                 const std::string& head, Packed packed) {
  if (description.components() != 1) throw std::logic_error("an image holds one number per sample");
  return std::make_unique<ImageWriter>(output, description, head, packed);
}

}  // namespace raycone
