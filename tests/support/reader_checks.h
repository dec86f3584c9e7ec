// What the tests of the mesh readers share: readers called on literals, and on every truncation of one.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include "io/files/file_error.h"
#include "io/mesh/read_mesh.h"
#include "tests/support/bytes.h"
#include "tests/support/error_text.h"

namespace raycone::test {

using MeshReader = ParsedMesh (*)(const NamedBytes&);

// Messages name the file "f".
inline ParsedMesh parse(MeshReader reader, std::string_view bytes) { return reader({"f", "", bytes}); }

// The message of the InputError that the reader throws; empty where it throws none.
inline std::string error_of(MeshReader reader, std::string_view bytes) {
  return error_text<InputError>([&] { return parse(reader, bytes); });
}

// Reads every proper prefix of `bytes`, each in an allocation of its exact size, so that the address sanitizer sees a
// read beyond the end. Each must load or throw InputError. Returns how many loaded.
inline int count_loading_prefixes(MeshReader reader, std::string_view bytes) {
  int loading = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::unique_ptr<char[]> copy(new char[size]);
    std::memcpy(copy.get(), bytes.data(), size);
    loading += error_of(reader, {copy.get(), size}).empty() ? 1 : 0;
  }
  return loading;
}

}  // namespace raycone::test
