// XML, element by element: a thin layer over Expat.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "io/files/byte_source.h"

namespace raycone {

// An element's attributes, valid while it is told. Names are "NAMESPACE|name", or "name" without a namespace.
class XmlAttributes {
 public:
  // As Expat passes them: names and values by turns, null at the end.
  // `place` tells "FILE(PART):LINE" for messages.
  XmlAttributes(const char** pairs, const std::function<std::string()>& place) : pairs_(pairs), place_(place) {}

  // Without the blanks around it.
  [[nodiscard]] std::optional<std::string_view> find(std::string_view name) const;
  // The same; throw InputError "PLACE: ..." where it is absent, or not such a number.
  [[nodiscard]] std::string_view text(std::string_view name) const;
  [[nodiscard]] double number(std::string_view name) const;  // finite
  [[nodiscard]] std::uint32_t index(std::string_view name) const;

  // Throws InputError "PLACE: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  const char** pairs_;
  const std::function<std::string()>& place_;
};

struct XmlHandler {
  std::function<void(std::string_view name, const XmlAttributes& attributes)> start;
  std::function<void(std::string_view name)> end;
  // Of a namespace, before the element that declares its prefix. May be empty.
  std::function<void(std::string_view prefix, std::string_view uri)> declare;
};

// Tells `handler` the elements of a document in order. Throws InputError where it is not well-formed, has a document
// type (which could define entities without end), or a token of more than a megabyte; and what the handler throws.
// Takes memory for one token and the names of open elements.
void read_xml(ByteSource& source, const std::string& name, const XmlHandler& handler);

}  // namespace raycone
