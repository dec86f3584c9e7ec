// The bytes of a VDB file on their way out: counted and hashed, for an identifier that follows from them.
#pragma once

#include <cstddef>
#include <streambuf>
#include <string>

#include "io/files/read_file.h"

namespace raycone::vdb {

// Passes all bytes on and hashes those behind the file header. Needs no memory to do so: what a stream's buffer throws
// the stream keeps to itself, and nothing that follows is written.
class HashingBuffer final : public std::streambuf {
 public:
  // The archive's identifier, 36 characters that OpenVDB draws at random, is the end of the file header.
  static constexpr std::size_t kIdentifierOffset = 21;
  static constexpr std::size_t kIdentifierSize = 36;

  explicit HashingBuffer(std::streambuf& target) : target_(target) {}

  // An identifier that depends on nothing but the bytes written.
  [[nodiscard]] std::string identifier() {
    std::string text = hash_.digest().substr(0, 32);
    for (const std::size_t position : {8U, 13U, 18U, 23U}) text.insert(position, 1, '-');
    return text;
  }

 protected:
  int_type overflow(int_type c) override {
    const char byte = traits_type::to_char_type(c);
    return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
  }
  std::streamsize xsputn(const char* data, std::streamsize size) override {
    const auto count = static_cast<std::size_t>(size);
    if (passed_ >= kIdentifierOffset + kIdentifierSize) hash_.add({data, count});
    passed_ += count;
    return target_.sputn(data, size);
  }
  int sync() override { return target_.pubsync(); }
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction, std::ios_base::openmode which) override {
    return target_.pubseekoff(offset, direction, which);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override {
    return target_.pubseekpos(position, which);
  }

 private:
  std::streambuf& target_;
  std::size_t passed_ = 0;
  Sha256 hash_;
};

}  // namespace raycone::vdb
