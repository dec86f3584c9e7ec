// One string, the values one after the other. Writing and reading follow the same code, which carries all members of a
// struct: with a member more than the number that is stated for the struct it does not compile. Numbers are as in
// memory, since both ends are the same executable on the same machine.
#include "app/batch/command_message.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "app/text/parse_value.h"

namespace raycone {
namespace {

class ValueWriter {
 public:
  template <typename Number>
  void number(const Number& number) {
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    bytes_.append(bytes, sizeof number);
  }
  void text(const std::string& text) {
    number(text.size());
    bytes_ += text;
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class ValueReader {
 public:
  explicit ValueReader(std::string_view bytes) : rest_(bytes) {}

  template <typename Number>
  void number(Number& number) {
    std::memcpy(&number, next(sizeof number).data(), sizeof number);
  }
  void text(std::string& text) {
    std::size_t size = 0;
    number(size);
    text = next(size);
  }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }

 private:
  std::string_view next(std::size_t size) {
    if (size > rest_.size()) throw std::runtime_error("a command ends within a value");
    const std::string_view bytes = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return bytes;
  }

  std::string_view rest_;
};

// Carries values to or from a stream.
template <typename Stream>
class Carrier {
 public:
  explicit Carrier(Stream& stream) : stream_(stream) {}

  template <typename... Values>
  void carry_all(Values&... values) {
    (carry(values), ...);
  }

 private:
  // --- Numbers, text and containers ---------------------------------------------------------------------------------

  template <typename Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void carry(Number& number) { stream_.number(number); }

  void carry(std::string& text) { stream_.text(text); }

  template <typename Value, std::size_t kSize>
  void carry(std::array<Value, kSize>& values) {
    for (Value& value : values) carry(value);
  }

  template <typename Value>
  void carry(std::optional<Value>& value) {
    bool given = value.has_value();
    carry(given);
    if (!given) return value.reset();
    if (!value) value.emplace();
    carry(*value);
  }

  template <typename Value>
  void carry(std::vector<Value>& values) {
    std::size_t size = values.size();
    carry(size);
    if (size < values.size()) values.resize(size);
    for (std::size_t n = 0; n < size; ++n) carry(n < values.size() ? values[n] : values.emplace_back());
  }

  template <typename... Alternatives>
  void carry(std::variant<Alternatives...>& variant) {
    std::size_t index = variant.index();
    carry(index);
    if (index != variant.index()) emplace_alternative(variant, index);
    std::visit([&](auto& value) { this->carry(value); }, variant);
  }

  template <typename... Alternatives>
  static void emplace_alternative(std::variant<Alternatives...>& variant, std::size_t index) {
    std::size_t n = 0;
    const bool known = ((index == n++ && (variant = Alternatives(), true)) || ...);
    if (!known) throw std::runtime_error("a command has an unknown alternative");
  }

  // --- Structs, of which each number of members is stated -----------------------------------------------------------

  void carry(Vec3& vector) { carry_members<3>(vector); }
  void carry(Box& box) { carry_members<2>(box); }
  void carry(ReadMeshOptions& options) { carry_members<3>(options); }
  void carry(Weld& weld) { carry_members<2>(weld); }
  void carry(Normalize& normalize) { carry_members<2>(normalize); }
  void carry(PartsOptions& options) { carry_members<2>(options); }
  void carry(MeshOptions& options) { carry_members<8>(options); }
  void carry(RunOptions& options) { carry_members<8>(options); }
  void carry(Rule& rule) { carry_members<2>(rule); }
  void carry(FieldOptions& options) { carry_members<8>(options); }
  void carry(OutputFiles& files) { carry_members<4>(files); }
  void carry(FieldEncoding& encoding) { carry_members<5>(encoding); }
  void carry(WorldPadding& padding) { carry_members<2>(padding); }
  void carry(VoxelPadding& padding) { carry_members<1>(padding); }
  void carry(LongestSide& side) { carry_members<1>(side); }
  void carry(SampleCounts& samples) { carry_members<1>(samples); }
  void carry(VoxelSize& voxel) { carry_members<1>(voxel); }
  void carry(LatticeRequest& request) { carry_members<4>(request); }
  void carry(GridReference& grid) { carry_members<2>(grid); }
  void carry(LatticeCommand& command) { carry_members<6>(command); }
  void carry(ReadPointsOptions& options) { carry_members<2>(options); }
  void carry(UniformSamples& samples) { carry_members<1>(samples); }
  void carry(NearSamples& samples) { carry_members<2>(samples); }
  void carry(SurfaceSamples& samples) { carry_members<1>(samples); }
  void carry(SampleRequest& request) { carry_members<4>(request); }
  void carry(PointsCommand& command) { carry_members<8>(command); }

  template <std::size_t kMembers, typename Struct>
  void carry_members(Struct& values) {
    static_assert(1 <= kMembers && kMembers <= 8);
    if constexpr (kMembers == 1) {
      auto& [a] = values;
      carry_all(a);
    } else if constexpr (kMembers == 2) {
      auto& [a, b] = values;
      carry_all(a, b);
    } else if constexpr (kMembers == 3) {
      auto& [a, b, c] = values;
      carry_all(a, b, c);
    } else if constexpr (kMembers == 4) {
      auto& [a, b, c, d] = values;
      carry_all(a, b, c, d);
    } else if constexpr (kMembers == 5) {
      auto& [a, b, c, d, e] = values;
      carry_all(a, b, c, d, e);
    } else if constexpr (kMembers == 6) {
      auto& [a, b, c, d, e, f] = values;
      carry_all(a, b, c, d, e, f);
    } else if constexpr (kMembers == 7) {
      auto& [a, b, c, d, e, f, g] = values;
      carry_all(a, b, c, d, e, f, g);
    } else if constexpr (kMembers == 8) {
      auto& [a, b, c, d, e, f, g, h] = values;
      carry_all(a, b, c, d, e, f, g, h);
    }
  }

  Stream& stream_;
};

}  // namespace

Message to_message(const MeshCommand& command) {
  ValueWriter writer;
  MeshCommand copy = command;  // reading, which does the same, changes it
  Carrier(writer).carry_all(copy);
  return {writer.take()};
}

MeshCommand mesh_command_from(const Message& message) {
  if (message.size() != 1) throw std::runtime_error("not a command");
  ValueReader reader(message.front());
  MeshCommand command;
  Carrier(reader).carry_all(command);
  if (!reader.at_end()) throw std::runtime_error("a command has more behind it");
  return command;
}

// A command is one string.
Message to_message(const InputsRequest& request) {
  Message message = to_message(request.command);
  message.push_back(std::to_string(request.started));
  std::ranges::copy(to_fields(request.stamp), std::back_inserter(message));
  return message;
}

std::optional<InputsRequest> inputs_request_from(const Message& message) {
  if (message.size() != 2 + kStampFields) return std::nullopt;
  const std::optional<std::int64_t> started = integer_from(message[1]);
  const std::optional<FileStamp> stamp = stamp_from(std::span(message).subspan<2, kStampFields>());
  if (!started || !stamp) return std::nullopt;
  return InputsRequest{mesh_command_from({message.front()}), *stamp, *started};
}

}  // namespace raycone
