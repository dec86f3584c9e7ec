// A file in memory, with the name that messages about it use.
#pragma once

#include <string>
#include <string_view>

namespace raycone {

struct NamedBytes {
  std::string name;       // as given on the command line
  std::string directory;  // where relative URIs of glTF start; empty: they are refused (standard input)
  std::string_view bytes;
};

}  // namespace raycone
