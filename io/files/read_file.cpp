// Files are read, not mapped: one that shrinks meanwhile would raise SIGBUS in a mapping.
#include "io/files/read_file.h"

#include <nettle/sha2.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <system_error>

#include "io/files/byte_source.h"
#include "io/files/file_error.h"

namespace raycone {

void fail_to_read(const std::string& path, int error) {
  if (error == EISDIR) throw InputError(path + ": is a directory, expected a file");
  const std::string what = path + ": cannot be read: " + std::generic_category().message(error);
  const bool is_there = error != ENOENT && error != ENOTDIR && error != ELOOP && error != ENAMETOOLONG;
  if (is_there) throw UnreadableError(what);
  throw InputError(what);
}

namespace {

[[noreturn]] void fail_too_large(const std::string& path, std::uint64_t max_bytes) {
  throw LimitError(path + ": larger than " + std::to_string(max_bytes) + " bytes, expected a smaller file");
}

}  // namespace

std::string read_file(const std::string& path, std::uint64_t max_bytes) {
  const std::unique_ptr<ByteSource> source = open_source(path);
  const std::uint64_t expected = source->size().value_or(0);
  if (expected > max_bytes) fail_too_large(path, max_bytes);

  constexpr std::size_t kOfUnknown = std::size_t{1} << 16;
  std::string bytes;
  // One byte more than expected, so that the end is seen without growing.
  bytes.resize(expected > 0 ? static_cast<std::size_t>(expected) + 1 : kOfUnknown);
  std::size_t size = 0;
  for (;;) {
    if (size == bytes.size()) bytes.resize(2 * size);
    const std::size_t count = source->read(bytes.data() + size, bytes.size() - size);
    if (count == 0) break;
    size += count;
    if (size > max_bytes) fail_too_large(path, max_bytes);
  }
  bytes.resize(size);
  return bytes;
}

std::string first_bytes(const std::string& path, std::size_t count) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  std::string first(count, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), static_cast<std::streamsize>(count));
  first.resize(static_cast<std::size_t>(file.gcount()));
  return first;
}

bool file_starts_with(const std::string& path, std::string_view bytes) {
  return first_bytes(path, bytes.size()) == bytes;
}

struct Sha256::State {
  sha256_ctx context;
};

Sha256::Sha256() : state_(std::make_unique<State>()) { sha256_init(&state_->context); }
Sha256::~Sha256() = default;

void Sha256::add(std::string_view bytes) {
  sha256_update(&state_->context, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
}

std::string Sha256::digest() {
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> bytes{};
  sha256_digest(&state_->context, bytes.size(), bytes.data());
  constexpr char kHexDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kHexDigits[byte >> 4];
    text += kHexDigits[byte & 15];
  }
  return text;
}

std::string sha256(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.digest();
}

std::string sha256_of_file(const std::string& path) {
  const std::unique_ptr<ByteSource> source = open_source(path);
  Sha256 hash;
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  const auto block = std::make_unique_for_overwrite<char[]>(kBlock);
  for (;;) {
    const std::size_t count = source->read(block.get(), kBlock);
    if (count == 0) return hash.digest();
    hash.add({block.get(), count});
  }
}

}  // namespace raycone
