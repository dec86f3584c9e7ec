// What unpacks gzip, Zstandard and deflate.
#include "io/files/unpack.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "io/files/file_error.h"
#include "tests/support/error_text.h"

namespace raycone {
namespace {

constexpr int kGzip = 15 + 16, kBare = -15;  // as zlib counts

// `flush`: Z_FINISH, or Z_SYNC_FLUSH where more may follow.
std::string deflated(std::string_view bytes, int window, int strategy = Z_DEFAULT_STRATEGY, int flush = Z_FINISH) {
  z_stream stream{};
  if (deflateInit2(&stream, 9, Z_DEFLATED, window, 8, strategy) != Z_OK) throw std::bad_alloc();
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, flush), flush == Z_FINISH ? Z_STREAM_END : Z_OK);
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
    for (std::size_t size = piece - 3; size < piece + 270; ++size) {
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

// At most so many bytes of memory were resident at a time.
std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

TEST(Unpack, TakesLittleMoreMemoryThanItsResult) {
  constexpr std::size_t kSize = std::size_t{1} << 24;
  std::string bytes(kSize, '\0');
  std::mt19937 random(1);
  for (std::size_t n = 0; n < kSize; n += 4) {
    const auto word = static_cast<std::uint32_t>(random());
    std::memcpy(&bytes[n], &word, 4);
  }
  const std::string packed = deflated(bytes, kGzip);  // takes as much
  const std::size_t before = peak_memory();
  EXPECT_EQ(unpacked(packed, "f"), bytes);
  EXPECT_LT(peak_memory() - before, 2.5 * kSize);
}

// --- Bytes that arrive by and by ------------------------------------------------------------------------------------

// What a client has sent and not closed: to read more is to wait for ever.
class OpenPipe final : public ByteSource {
 public:
  explicit OpenPipe(std::string sent) : sent_(std::move(sent)) {}

  std::size_t read(char* bytes, std::size_t size) override {
    if (begin_ == sent_.size()) throw std::logic_error("waits");
    const std::size_t count = sent_.copy(bytes, size, begin_);
    begin_ += count;
    return count;
  }
  bool is_ready() override { return begin_ < sent_.size(); }

 private:
  std::string sent_;
  std::size_t begin_ = 0;
};

// All that comes without waiting of packed bytes that have been sent.
std::string arrived(const std::string& sent) {
  const auto source = unpacked(std::make_unique<OpenPipe>(sent), "f");
  std::string all, bytes(std::size_t{1} << 18, '\0');
  while (source->is_ready()) all.append(bytes, 0, source->read(bytes.data(), bytes.size()));
  return all;
}

// Frames of one block each, that says `byte` some times (RFC 8878, 3.1.1); a byte of it before and behind. By default
// their window has 128 KiB.
std::string zstandard_frame(char byte, std::uint32_t times, char window = '\x38') {
  const std::uint32_t head = times << 3 | 1 << 1 | 1;  // a run, the last block
  std::string frame = std::string("\x28\xb5\x2f\xfd\x00", 5) + window;
  for (int n = 0; n < 3; ++n) frame += static_cast<char>(head >> (8 * n) & 0xFF);
  return frame + byte;
}

// As `zstd --long=28` makes them.
TEST(Unpack, TakesZstandardFramesOfLargeWindows) {
  constexpr char kQuarterOfGigabyte = '\x90';
  EXPECT_EQ(arrived(zstandard_frame('a', 7, kQuarterOfGigabyte)), "aaaaaaa");
  constexpr char kFourGigabytes = '\xB0';
  const std::string refused =
      test::error_text<InputError>([&] { return arrived(zstandard_frame('a', 7, kFourGigabytes)); });
  EXPECT_NE(refused.find("a window of more than 2 GB, expected"), std::string::npos) << refused;
}

TEST(Unpack, GivesAllThatHasComeOfZstandardFrames) {
  std::string sent, expected;
  for (int n = 0; n < 5; ++n) {
    for (const std::uint32_t times : {1u, 131072u, 131071u, 7u}) {
      sent += zstandard_frame('a', times);
      expected.append(times, 'a');
      EXPECT_EQ(arrived(sent).size(), expected.size());
    }
  }
  const std::string begun = sent + zstandard_frame('b', 10);
  for (std::size_t cut = 1; cut < 10; ++cut) EXPECT_EQ(arrived(begun.substr(0, sent.size() + cut)), expected) << cut;
}

TEST(Unpack, GivesAllThatHasComeOfDeflatedBytes) {
  for (std::size_t size = (1 << 17) - 2; size < (1 << 17) + 300; size += 5) {
    const std::string bytes = "x" + std::string(size - 1, '\0');
    const std::string sent = deflated(bytes, kGzip, Z_DEFAULT_STRATEGY, Z_SYNC_FLUSH);
    ASSERT_EQ(arrived(sent).size(), size);
    // The empty block that ends what is flushed holds nothing; without it, some of a match may.
    for (const std::size_t cut : {1, 2, 3, 4}) ASSERT_EQ(arrived(sent.substr(0, sent.size() - cut)).size(), size);
  }
}

TEST(Unpack, WaitsForMoreOfATrailer) {
  const std::string bytes(1000, 'x'), packed = deflated(bytes, kGzip);
  for (std::size_t cut = 0; cut <= 8; ++cut) {
    EXPECT_EQ(arrived(packed.substr(0, packed.size() - cut)), bytes) << cut;
    EXPECT_EQ(arrived(packed + packed.substr(0, packed.size() - cut)), bytes + bytes) << cut;
  }
}

}  // namespace
}  // namespace raycone
