#include "io/mesh/xml_reader.h"

#include <expat.h>

#include <charconv>
#include <cmath>
#include <exception>
#include <memory>
#include <new>
#include <type_traits>

#include "io/files/ascii.h"
#include "io/files/file_error.h"
#include "io/files/text_scanner.h"

namespace raycone {
namespace {

constexpr char kSeparator = '|';

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

struct FreeParser {
  void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
};

// What the callbacks of one document share. No exception may cross Expat, so that they are kept for later.
class Document {
 public:
  Document(const std::string& name, const XmlHandler& handler)
      : name_(name), handler_(handler), parser_(XML_ParserCreateNS(nullptr, kSeparator)) {
    if (!parser_) throw std::bad_alloc();
    XML_SetUserData(parser(), this);
    XML_SetElementHandler(parser(), &Document::started, &Document::ended);
    XML_SetStartNamespaceDeclHandler(parser(), &Document::declared);
    XML_SetStartDoctypeDeclHandler(parser(), &Document::doctype);
  }

  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  void read(ByteSource& source) {
    constexpr int kBlock = 1 << 16;
    constexpr XML_Index kLongestToken = 1 << 20;
    for (XML_Index done = 0;;) {
      void* const room = XML_GetBuffer(parser(), kBlock);
      if (room == nullptr) throw std::bad_alloc();
      const std::size_t count = source.read(static_cast<char*>(room), kBlock);
      const XML_Status status = XML_ParseBuffer(parser(), static_cast<int>(count), count == 0);
      if (failure_) std::rethrow_exception(failure_);
      if (status != XML_STATUS_OK) fail_as_expat_says();
      if (count == 0) return;
      done += static_cast<XML_Index>(count);
      if (done - XML_GetCurrentByteIndex(parser()) > kLongestToken) {
        throw InputError(place() + ": a tag or comment of more than a megabyte, expected a shorter one");
      }
    }
  }

 private:
  [[nodiscard]] XML_Parser parser() const { return parser_.get(); }

  [[nodiscard]] std::string place() const { return name_ + ':' + std::to_string(XML_GetCurrentLineNumber(parser())); }

  [[noreturn]] void fail_as_expat_says() const {
    const XML_Error error = XML_GetErrorCode(parser());
    if (error == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
    throw InputError(place() + ": not well-formed XML: " + XML_ErrorString(error));
  }

  template <class Call>
  void keep_failure(const Call& call) {
    if (failure_) return;
    try {
      call();
    } catch (...) {
      failure_ = std::current_exception();
      XML_StopParser(parser(), XML_FALSE);
    }
  }

  static void started(void* self, const char* name, const char** attributes) {
    auto& document = *static_cast<Document*>(self);
    document.keep_failure([&] {
      constexpr int kDeepest = 256;  // Expat remembers each element that is open
      if (++document.depth_ > kDeepest)
        throw InputError(document.place() + ": elements within elements, more than 256");
      document.handler_.start(name, XmlAttributes(attributes, document.tell_place_));
    });
  }
  static void ended(void* self, const char* name) {
    auto& document = *static_cast<Document*>(self);
    --document.depth_;
    document.keep_failure([&] { document.handler_.end(name); });
  }
  static void declared(void* self, const char* prefix, const char* uri) {
    auto& document = *static_cast<Document*>(self);
    if (!document.handler_.declare) return;
    document.keep_failure([&] { document.handler_.declare(prefix ? prefix : "", uri ? uri : ""); });
  }
  static void doctype(void* self, const char*, const char*, const char*, int) {
    auto& document = *static_cast<Document*>(self);
    document.keep_failure([&] { throw InputError(document.place() + ": a document type, expected none"); });
  }

  const std::string& name_;
  const XmlHandler& handler_;
  std::unique_ptr<std::remove_pointer_t<XML_Parser>, FreeParser> parser_;
  std::function<std::string()> tell_place_ = [this] { return place(); };
  std::exception_ptr failure_;
  int depth_ = 0;
};

}  // namespace

std::optional<std::string_view> XmlAttributes::find(std::string_view name) const {
  for (const char** pair = pairs_; *pair != nullptr; pair += 2) {
    if (name == pair[0]) return trimmed(pair[1]);
  }
  return std::nullopt;
}

std::string_view XmlAttributes::text(std::string_view name) const {
  const auto found = find(name);
  if (!found) fail("no attribute " + std::string(name));
  return *found;
}

double XmlAttributes::number(std::string_view name) const {
  const std::string_view value = text(name);
  const auto number = number_of(value);
  if (!number || !std::isfinite(*number)) {
    fail(std::string(name) + " is '" + excerpt(value) + "', expected a finite number");
  }
  return *number;
}

std::uint32_t XmlAttributes::index(std::string_view name) const {
  const std::string_view value = text(name);
  std::uint32_t index = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), index);
  if (error != std::errc() || end != value.data() + value.size()) {
    fail(std::string(name) + " is '" + excerpt(value) + "', expected an index of 32 bits");
  }
  return index;
}

void XmlAttributes::fail(const std::string& what) const { throw InputError(place_() + ": " + what); }

void read_xml(ByteSource& source, const std::string& name, const XmlHandler& handler) {
  Document(name, handler).read(source);
}

}  // namespace raycone
