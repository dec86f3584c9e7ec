// Buffered writing to a file descriptor, as a standard stream buffer.
#pragma once

#include <cstddef>
#include <memory>
#include <streambuf>

namespace raycone {

// Does not own the descriptor. The first failure sticks: error() tells it and everything after it fails too. Positions
// count from the first byte written here; others than the one where it is can be sought only where the descriptor can
// and began at its byte 0.
class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(int descriptor);

  // errno of the first failure; 0 while there is none.
  [[nodiscard]] int error() const { return error_; }

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* data, std::streamsize size) override;
  int sync() override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction, std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
  bool write_through(const char* data, std::size_t size);

  int descriptor_;
  int error_ = 0;
  off_type start_ = 0;             // position of the first buffered byte
  std::unique_ptr<char[]> bytes_;  // not set before they are written: small outputs touch few pages of memory
};

}  // namespace raycone
