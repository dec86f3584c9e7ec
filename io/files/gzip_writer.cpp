#include "io/files/gzip_writer.h"

#include <zlib.h>

#include <algorithm>
#include <new>
#include <vector>

namespace raycone {

struct GzipWriter::State {
  OutputFile& output;
  z_stream stream{};
  std::vector<char> packed = std::vector<char>(std::size_t{1} << 17);

  // Packs what is to come in, and writes what comes out.
  void pack(int flush) {
    int result = Z_OK;
    do {
      stream.next_out = reinterpret_cast<Bytef*>(packed.data());
      stream.avail_out = static_cast<uInt>(packed.size());
      result = deflate(&stream, flush);
      output.write(packed.data(), packed.size() - stream.avail_out);
    } while (stream.avail_in > 0 || (flush == Z_FINISH && result != Z_STREAM_END));
  }
};

GzipWriter::GzipWriter(OutputFile& output) : state_(new State{output}) {
  constexpr int kGzipWindow = 15 + 16, kDefaultMemory = 8, kFast = 4;  // fields pack well at any level
  if (deflateInit2(&state_->stream, kFast, Z_DEFLATED, kGzipWindow, kDefaultMemory, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
}

GzipWriter::~GzipWriter() { deflateEnd(&state_->stream); }

void GzipWriter::write(const void* data, std::size_t size) {
  constexpr std::size_t kMost = std::size_t{1} << 30;  // zlib counts in 32 bits
  const auto* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const std::size_t count = std::min(size, kMost);
    state_->stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes));
    state_->stream.avail_in = static_cast<uInt>(count);
    state_->pack(Z_NO_FLUSH);
    bytes += count;
    size -= count;
  }
}

void GzipWriter::finish() {
  state_->stream.avail_in = 0;
  state_->pack(Z_FINISH);
}

}  // namespace raycone
