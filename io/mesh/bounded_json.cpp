#include "io/mesh/bounded_json.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "io/files/ascii.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

using Json = nlohmann::json;

// Deeper than any exporter writes, and far from what a stack would notice.
constexpr std::size_t kMaxDepth = 256;
// Objects and arrays: a parsed one takes up to a hundred times the memory of its text "{}".
constexpr std::uint64_t kMaxContainers = 5'000'000;

// The place of byte `offset` of the JSON text: a line, or a byte of the GLB.
std::string place_of(const JsonText& text, std::size_t offset) {
  if (text.offset) return "byte " + std::to_string(*text.offset + offset);
  const auto end = text.json.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text.json.size()));
  return std::to_string(1 + std::count(text.json.begin(), end, '\n'));
}

// The library's message without its own prefix and place.
std::string reason_of(const std::string& message) {
  std::string reason = message;
  for (const std::string_view prefix : {"] ", ": syntax error "}) {
    const std::size_t found = reason.find(prefix);
    if (found != std::string::npos) reason = reason.substr(found + prefix.size());
  }
  return excerpt(reason);
}

// Builds the wanted part of the document as the parser meets it. The library's own filter, a callback, takes time
// quadratic in the length of an array.
class DocumentBuilder : public nlohmann::json_sax<Json> {
 public:
  DocumentBuilder(const JsonText& text, IsWanted is_wanted, UnwindingReserve& reserve)
      : text_(text), is_wanted_(is_wanted), reserve_(reserve) {}

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
    if (is_wanted_(open_.size(), key)) {
      // Which of the two is meant, nobody can tell.
      if (open_.back()->contains(key)) {
        throw InputError(text_.file + ": JSON with two members '" + excerpt(key) + "' in one object, expected one");
      }
      member_ = &(*open_.back())[std::move(key)];
    } else {
      skipped_from_ = open_.size();
    }
    return true;
  }

  bool parse_error(std::size_t offset, const std::string&, const nlohmann::detail::exception& error) override {
    throw InputError(text_.file + ":" + place_of(text_, offset) + ": " + reason_of(error.what()) + ", expected " +
                     text_.expected);
  }

 private:
  static constexpr std::size_t kFirstReserve = 1024;  // values

  [[nodiscard]] bool skipping() const { return skipped_from_ != 0; }

  // Puts a value where the parser is; the result is valid until the next value of the same array.
  Json* put(Json value) {
    if (++values_ > reserve_.covered()) reserve_.cover(kFirstReserve + values_ + values_ / 4);
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

  const JsonText& text_;
  IsWanted is_wanted_;
  UnwindingReserve& reserve_;
  std::size_t values_ = 0;  // kept
  Json document_;
  std::vector<Json*> open_;       // containers the parser is in; nullptr for skipped ones
  Json* member_ = nullptr;        // of the innermost object, named by the last key
  std::size_t skipped_from_ = 0;  // number of open containers at a skipped key; 0: nothing is being skipped
  std::uint64_t containers_ = 0;
};

}  // namespace

nlohmann::json parse_bounded_json(const JsonText& text, IsWanted is_wanted, UnwindingReserve& reserve) {
  DocumentBuilder builder(text, is_wanted, reserve);
  Json::sax_parse(text.json.begin(), text.json.end(), &builder);
  return builder.take();
}

}  // namespace raycone
