#include "io/files/unpack.h"

#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <new>
#include <utility>
#include <vector>

#include "io/files/ascii.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

constexpr std::string_view kGzipMagic = "\x1f\x8b", kZstandardMagic = "\x28\xb5\x2f\xfd";
// Behind a byte from 0x50 to 0x5F: a frame of Zstandard that is skipped. pzstd begins its files with one.
constexpr std::string_view kSkippableMagic = "\x2a\x4d\x18";
constexpr std::size_t kMagic = 4;  // bytes that tell, at most
constexpr std::size_t kUnpackedBlock = std::size_t{1} << 17;
constexpr int kGzipWindow = 15 + 16, kBareWindow = -15;  // as zlib counts

enum class Packing { kNone, kGzip, kZstandard };

Packing packing_of(std::string_view bytes) {
  if (bytes.starts_with(kGzipMagic)) return Packing::kGzip;
  const bool is_skippable =
      !bytes.empty() && (bytes.front() & 0xF0) == 0x50 && bytes.substr(1).starts_with(kSkippableMagic);
  return is_skippable || bytes.starts_with(kZstandardMagic) ? Packing::kZstandard : Packing::kNone;
}

// Whether more bytes may make it packed.
bool may_become_packed(std::string_view bytes) {
  if (bytes.size() >= kMagic || packing_of(bytes) != Packing::kNone) return false;
  if (bytes.empty() || kGzipMagic.starts_with(bytes) || kZstandardMagic.starts_with(bytes)) return true;
  return (bytes.front() & 0xF0) == 0x50 && kSkippableMagic.starts_with(bytes.substr(1));
}

// Packed bytes, block by block.
class PackedInput {
 public:
  PackedInput(std::unique_ptr<ByteSource> source, std::string name, std::string_view begun = {})
      : source_(std::move(source)), name_(std::move(name)), bytes_(kUnpackedBlock) {
    std::ranges::copy(begun, bytes_.begin());
    end_ = begun.size();
  }

  // What has been read and not consumed.
  [[nodiscard]] std::string_view pending() const { return {bytes_.data() + begin_, end_ - begin_}; }
  // Reads more, once nothing is pending; false at the end.
  bool fill() {
    begin_ = 0;
    end_ = source_->read(bytes_.data(), bytes_.size());
    return end_ > 0;
  }
  void consume(std::size_t count) {
    begin_ += count;
    offset_ += count;
  }
  [[nodiscard]] bool is_ready() { return begin_ < end_ || source_->is_ready(); }

  [[noreturn]] void fail(const std::string& what) const { fail_at_byte(name_, offset_, what); }

 private:
  std::unique_ptr<ByteSource> source_;
  std::string name_;
  std::vector<char> bytes_;
  std::size_t begin_ = 0, end_ = 0;
  std::uint64_t offset_ = 0;
};

// Reads through a decoder. That one may hold bytes for which there was no room, and what has come of its input may
// yield none: only decoding ahead tells whether there is a byte.
class DecodingSource : public ByteSource {
 public:
  explicit DecodingSource(PackedInput input) : input_(std::move(input)) {}

  std::size_t read(char* bytes, std::size_t size) final {
    std::size_t count = take_ahead(bytes, size);
    while (count == 0 && !at_end_) count = decode_some(bytes, size);
    return count;
  }
  bool is_ready() final {
    while (begin_ == end_ && !at_end_) {
      if (!was_full_ && !input_.is_ready()) return false;
      ahead_.resize(kUnpackedBlock);
      begin_ = 0;
      end_ = decode_some(ahead_.data(), ahead_.size());
    }
    return true;
  }
  bool is_checked_at_end() const final { return true; }

 protected:
  // Decodes what it holds, and what is pending of input(), as far as there is room, and returns the number of bytes.
  virtual std::size_t decode(char* bytes, std::size_t size) = 0;
  // Whether the input may end here.
  [[nodiscard]] virtual bool may_end() const = 0;

  PackedInput& input() { return input_; }
  void set_end() { at_end_ = true; }
  [[noreturn]] void fail_as_damaged(const char* what) const {
    input_.fail(std::string("damaged compressed data: ") + what);
  }

 private:
  // Waits where the decoder holds nothing and needs input. May return 0 before the end.
  std::size_t decode_some(char* bytes, std::size_t size) {
    if (!was_full_ && input_.pending().empty() && !input_.fill()) {
      if (!may_end()) input_.fail("the compressed data end too early");
      set_end();
      return 0;
    }
    const std::size_t room = std::min(size, kUnpackedBlock), count = decode(bytes, room);
    was_full_ = count == room;
    return count;
  }

  std::size_t take_ahead(char* bytes, std::size_t size) {
    const std::size_t count = std::min(size, end_ - begin_);
    std::copy_n(ahead_.begin() + static_cast<std::ptrdiff_t>(begin_), count, bytes);
    begin_ += count;
    return count;
  }

  PackedInput input_;
  std::vector<char> ahead_;  // bytes decoded before they were asked for are those in [begin_, end_)
  std::size_t begin_ = 0, end_ = 0;
  bool was_full_ = false;  // the room, so that the decoder may hold more
  bool at_end_ = false;
};

// By zlib: gzip files, or bare deflate, behind which nothing needs to be: what zlib holds may be all that is left.
class InflatingSource final : public DecodingSource {
 public:
  InflatingSource(PackedInput packed, int window, std::optional<std::uint64_t> size)
      : DecodingSource(std::move(packed)), is_gzip_(window == kGzipWindow), size_(size) {
    if (inflateInit2(&state_, window) != Z_OK) throw std::bad_alloc();
  }
  ~InflatingSource() override { inflateEnd(&state_); }
  InflatingSource(const InflatingSource&) = delete;
  InflatingSource& operator=(const InflatingSource&) = delete;

  std::optional<std::uint64_t> size() const override { return size_; }

 private:
  std::size_t decode(char* bytes, std::size_t size) override {
    if (between_ && !begins_member()) return 0;
    const std::string_view packed = input().pending();
    state_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    state_.avail_in = static_cast<uInt>(packed.size());
    state_.next_out = reinterpret_cast<Bytef*>(bytes);
    state_.avail_out = static_cast<uInt>(size);
    const int result = inflate(&state_, Z_NO_FLUSH);
    input().consume(packed.size() - state_.avail_in);
    if (result == Z_MEM_ERROR) throw std::bad_alloc();
    const std::size_t count = size - state_.avail_out;
    done_ += count;
    if (result == Z_STREAM_END) {
      end_member();
    } else if (result != Z_OK && result != Z_BUF_ERROR) {
      fail_as_damaged(state_.msg != nullptr ? state_.msg : "a dictionary");
    } else if (size_ && done_ > *size_) {
      fail_as_of_another_size();
    }
    return count;
  }

  void end_member() {
    between_ = is_gzip_;
    if (is_gzip_) return;
    if (size_ && done_ != *size_) fail_as_of_another_size();
    set_end();
  }

  // Behind a gzip file may be another one, and zeros that fill a block of a tape.
  bool begins_member() {
    const std::string_view packed = input().pending();
    if (packed.empty()) return false;
    if (packed.front() == '\0') {
      input().consume(1);
      return false;
    }
    if (packed.front() != kGzipMagic.front()) input().fail("something other than compressed data behind them");
    between_ = false;
    inflateReset(&state_);
    return true;
  }

  bool may_end() const override { return between_; }
  [[noreturn]] void fail_as_of_another_size() { input().fail("another size than announced"); }

  z_stream state_{};
  bool is_gzip_;
  std::optional<std::uint64_t> size_;
  bool between_ = false;  // two gzip files
  std::uint64_t done_ = 0;
};

class ZstandardSource final : public DecodingSource {
 public:
  explicit ZstandardSource(PackedInput packed)
      : DecodingSource(std::move(packed)), state_(ZSTD_createDStream(), &ZSTD_freeDStream) {
    if (!state_) throw std::bad_alloc();
    // By default frames of more than 128 MB are refused; the memory limit knows better.
    ZSTD_DCtx_setParameter(state_.get(), ZSTD_d_windowLogMax, ZSTD_dParam_getBounds(ZSTD_d_windowLogMax).upperBound);
  }

 private:
  std::size_t decode(char* bytes, std::size_t size) override {
    const std::string_view packed = input().pending();
    if (packed.empty() && !within_) return 0;
    ZSTD_inBuffer in{packed.data(), packed.size(), 0};
    ZSTD_outBuffer out{bytes, size, 0};
    const std::size_t result = ZSTD_decompressStream(state_.get(), &out, &in);
    input().consume(in.pos);
    if (ZSTD_getErrorCode(result) == ZSTD_error_memory_allocation) throw std::bad_alloc();
    if (ZSTD_getErrorCode(result) == ZSTD_error_frameParameter_windowTooLarge) {
      input().fail("a window of more than 2 GB, expected a smaller one (zstd --long=31 or less)");
    }
    if (ZSTD_isError(result)) fail_as_damaged(ZSTD_getErrorName(result));
    within_ = result != 0;
    return out.pos;
  }

  bool may_end() const override { return !within_; }

  std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> state_;
  bool within_ = false;  // a frame
};

// Decides at the first byte, so that nothing waits before.
class UnpackingSource final : public ByteSource {
 public:
  UnpackingSource(std::unique_ptr<ByteSource> source, std::string name)
      : source_(std::move(source)), name_(std::move(name)) {}

  std::size_t read(char* bytes, std::size_t size) override {
    if (!is_known_) find_out();
    if (begun_.empty()) return at_end_ ? 0 : source_->read(bytes, size);
    const std::size_t count = std::min(size, begun_.size());
    std::memcpy(bytes, begun_.data(), count);
    begun_.erase(0, count);
    return count;
  }
  bool is_ready() override { return !begun_.empty() || source_->is_ready(); }
  bool is_checked_at_end() const override { return source_->is_checked_at_end(); }
  std::optional<std::uint64_t> size() const override { return source_->size(); }
  bool is_seekable() const override { return source_->is_seekable(); }
  void read_at(std::uint64_t offset, char* bytes, std::size_t size) const override {
    source_->read_at(offset, bytes, size);
  }

 private:
  void find_out() {
    is_known_ = true;
    std::array<char, kMagic> first{};
    while (may_become_packed(begun_)) {
      const std::size_t count = source_->read(first.data(), first.size() - begun_.size());
      if (count == 0) {
        at_end_ = true;  // of a terminal, which would ask again
        break;
      }
      begun_.append(first.data(), count);
    }
    const Packing packing = packing_of(begun_);
    if (packing == Packing::kGzip) {
      source_ = std::make_unique<InflatingSource>(take_input(), kGzipWindow, std::nullopt);
    } else if (packing == Packing::kZstandard) {
      source_ = std::make_unique<ZstandardSource>(take_input());
    }
  }

  PackedInput take_input() {
    PackedInput input(std::move(source_), name_, begun_);
    begun_.clear();
    at_end_ = false;
    return input;
  }

  std::unique_ptr<ByteSource> source_;
  std::string name_;
  std::string begun_;  // bytes that were read to find out
  bool is_known_ = false;
  bool at_end_ = false;
};

// The next `size` bytes, less at the end.
std::string next_piece(ByteSource& source, std::size_t size) {
  std::string bytes(size, '\0');
  std::size_t done = 0, count = 0;
  do {
    count = source.read(bytes.data() + done, size - done);
    done += count;
  } while (count > 0 && done < size);
  bytes.resize(done);
  return bytes;
}

}  // namespace

bool is_packed(std::string_view bytes) { return packing_of(bytes) != Packing::kNone; }

std::unique_ptr<ByteSource> unpacked(std::unique_ptr<ByteSource> packed, const std::string& name) {
  return std::make_unique<UnpackingSource>(std::move(packed), name);
}

// In pieces, which are given back as they are joined: nobody knows the size, and room for it that grows would for a
// while take more than twice as much.
std::string unpacked(std::string_view packed, const std::string& name) {
  const std::unique_ptr<ByteSource> source = unpacked(open_bytes(packed), name);
  std::deque<std::string> pieces;
  std::size_t size = 0;
  do {
    pieces.push_back(next_piece(*source, std::max(kUnpackedBlock, size / 8)));
    size += pieces.back().size();
  } while (!pieces.back().empty());
  std::string bytes;
  bytes.reserve(size);
  for (; !pieces.empty(); pieces.pop_front()) bytes += pieces.front();
  return bytes;
}

std::unique_ptr<ByteSource> inflated(std::unique_ptr<ByteSource> packed, std::uint64_t size, const std::string& name) {
  return std::make_unique<InflatingSource>(PackedInput(std::move(packed), name), kBareWindow, size);
}

std::string without_packing_extension(const std::string& path) {
  for (const std::string_view extension : {".gz", ".zst"}) {
    const bool is_packed = path.size() > extension.size() && ends_with_word(path, extension);
    if (is_packed) return path.substr(0, path.size() - extension.size());
  }
  return path;
}

}  // namespace raycone
