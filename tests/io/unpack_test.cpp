// What unpacks gzip, Zstandard and deflate.
#include "io/files/unpack.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <string>
#include <string_view>

#include "io/files/file_error.h"

namespace raycone {
namespace {

constexpr int kGzip = 15 + 16, kBare = -15;  // as zlib counts

std::string deflated(std::string_view bytes, int window, int strategy = Z_DEFAULT_STRATEGY) {
  z_stream stream{};
  if (deflateInit2(&stream, 9, Z_DEFLATED, window, 8, strategy) != Z_OK) throw std::bad_alloc();
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

// All that there is, read in pieces of at most `piece` bytes.
std::string all_of(ByteSource& source, std::size_t piece) {
  std::string all, bytes(piece, '\0');
  while (const std::size_t count = source.read(bytes.data(), bytes.size())) all.append(bytes, 0, count);
  return all;
}

// XML is read by 64 KiB, arrays by 128. Where a match takes few bits, the end of the data is in the byte that the last
// one ends in.
TEST(Unpack, InflatesWhatIsLittleLongerThanAPiece) {
  for (const std::size_t piece : {std::size_t{1} << 16, std::size_t{1} << 17, std::size_t{1000}}) {
    for (std::size_t size = piece - 3; size < piece + 530; ++size) {
      for (const int strategy : {Z_DEFAULT_STRATEGY, Z_FIXED}) {
        const std::string bytes = "x" + std::string(size - 1, '\0');
        const std::string packed = deflated(bytes, kBare, strategy);
        ASSERT_EQ(all_of(*inflated(open_bytes(packed), size, "f"), piece), bytes) << piece << ' ' << size;
      }
    }
  }
}

TEST(Unpack, RefusesDeflatedBytesThatEndTooEarly) {
  for (const std::size_t size : {1000, 1300, 5000}) {
    const std::string packed = deflated(std::string(size, 'x'), kBare);
    for (std::size_t cut = 0; cut < packed.size(); ++cut) {
      const auto source = inflated(open_bytes(std::string_view(packed).substr(0, cut)), size, "f");
      EXPECT_THROW(all_of(*source, 1000), InputError) << size << ' ' << cut;
    }
    for (const std::size_t announced : {size - 1, size + 1}) {
      EXPECT_THROW(all_of(*inflated(open_bytes(packed), announced, "f"), 1000), InputError) << size;
    }
  }
}

TEST(Unpack, GivesWhatWasPackedInPiecesOfAnySize) {
  const std::string bytes = "x" + std::string(3000, '\0');
  const std::string once = deflated(bytes, kGzip), twice = once + once;
  for (std::size_t piece = 1; piece < 300; ++piece) {
    ASSERT_EQ(all_of(*unpacked(open_bytes(once), "f"), piece), bytes) << piece;
    ASSERT_EQ(all_of(*unpacked(open_bytes(twice), "f"), piece), bytes + bytes) << piece;
  }
}

}  // namespace
}  // namespace raycone
