// Numbers of sections are those of PKWARE's APPNOTE.TXT 6.3.10.
#include "io/files/zip_reader.h"

#include <zlib.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "io/files/ascii.h"
#include "io/files/file_error.h"
#include "io/files/unpack.h"

namespace raycone {
namespace {

constexpr std::uint64_t kLargest16 = 0xFFFF, kLargest32 = 0xFFFFFFFF;

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw InputError(path + ": not a readable ZIP archive: " + what);
}

// Little-endian fields, one after the other.
class Fields {
 public:
  Fields(std::string_view bytes, const std::string& path) : rest_(bytes), path_(path) {}

  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    const std::string_view bytes = text(size);
    for (std::size_t n = size; n-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[n]);
    return value;
  }
  std::string_view text(std::size_t size) {
    if (size > rest_.size()) fail(path_, "it ends within a record");
    const std::string_view bytes = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return bytes;
  }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
  const std::string& path_;
};

std::string bytes_at(const ByteSource& file, const std::string& path, std::uint64_t offset, std::uint64_t size) {
  const std::uint64_t end = file.size().value_or(0);
  if (offset > end || size > end - offset) fail(path, "a record lies beyond its end");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.read_at(offset, bytes.data(), bytes.size());
  return bytes;
}

struct Directory {
  std::uint64_t entries, size, offset;
};

// 4.3.14, 4.3.15: `end` is where the record of 4.3.16 begins. Nothing where there is no locator before it.
std::optional<Directory> large_directory(const ByteSource& file, const std::string& path, std::uint64_t end) {
  constexpr std::uint64_t kLocator = 20, kRecord = 56;
  if (end < kLocator) return std::nullopt;
  const std::string locator = bytes_at(file, path, end - kLocator, kLocator);
  Fields place(locator, path);
  if (place.number(4) != 0x07064b50) return std::nullopt;
  (void)place.number(4);  // disk
  const std::string record = bytes_at(file, path, place.number(8), kRecord);
  Fields fields(record, path);
  if (fields.number(4) != 0x06064b50) fail(path, "no ZIP64 directory");
  (void)fields.text(20);  // size, versions, disks
  (void)fields.number(8);
  Directory directory{};
  directory.entries = fields.number(8);
  directory.size = fields.number(8);
  directory.offset = fields.number(8);
  return directory;
}

// Where the record of the directory begins. Its comment may hold what looks like another one, and bytes may follow it.
std::size_t last_record(const std::string& tail, const std::string& path) {
  constexpr std::string_view kMark = "PK\x05\x06";
  constexpr std::size_t kRecord = 22, kComment = 20;
  std::optional<std::size_t> last;
  for (std::size_t at = tail.rfind(kMark); at != std::string::npos;
       at = at == 0 ? std::string::npos : tail.rfind(kMark, at - 1)) {
    if (tail.size() - at < kRecord) continue;
    Fields fields(std::string_view(tail).substr(at + kComment), path);
    if (at + kRecord + fields.number(2) == tail.size()) return at;
    if (!last) last = at;
  }
  if (!last) fail(path, "no directory at its end");
  return *last;
}

// 4.3.16
Directory find_directory(const ByteSource& file, const std::string& path) {
  constexpr std::uint64_t kRecord = 22;
  const std::uint64_t size = file.size().value_or(0);
  const std::uint64_t window = std::min(size, kRecord + kLargest16);  // a comment may stand behind
  const std::string tail = bytes_at(file, path, size - window, window);
  const std::size_t found = last_record(tail, path);
  Fields fields(std::string_view(tail).substr(found + 4), path);
  const std::uint64_t disk = fields.number(2), first_disk = fields.number(2);
  if ((disk != 0 && disk != kLargest16) || (first_disk != 0 && first_disk != kLargest16)) {
    fail(path, "it is in several parts");
  }
  (void)fields.number(2);
  Directory directory{};
  directory.entries = fields.number(2);
  directory.size = fields.number(4);
  directory.offset = fields.number(4);
  const bool large = directory.size == kLargest32 || directory.offset == kLargest32;
  if (!large && directory.entries != kLargest16) return directory;
  if (const auto of_zip64 = large_directory(file, path, size - window + found)) return *of_zip64;
  if (large) fail(path, "no ZIP64 directory");
  return directory;  // of exactly so many entries
}

// 4.5.3: what did not fit into 32 bits.
void read_extra(Fields extra, ZipReader::Member& member) {
  while (extra.left() >= 4) {
    const std::uint64_t kind = extra.number(2), size = extra.number(2);
    Fields field = extra;
    (void)extra.text(static_cast<std::size_t>(size));
    if (kind != 1) continue;
    for (std::uint64_t* const number : {&member.size, &member.packed_size, &member.header}) {
      if (*number == kLargest32) *number = field.number(8);
    }
  }
}

// 4.3.12
ZipReader::Member read_entry(Fields& fields, const std::string& path) {
  constexpr std::uint64_t kEncrypted = 1, kStored = 0, kDeflated = 8;
  if (fields.number(4) != 0x02014b50) fail(path, "its directory is damaged");
  (void)fields.number(4);  // versions
  const std::uint64_t flags = fields.number(2), method = fields.number(2);
  (void)fields.text(4);  // time, date
  ZipReader::Member member;
  member.checksum = static_cast<std::uint32_t>(fields.number(4));
  member.packed_size = fields.number(4);
  member.size = fields.number(4);
  const std::uint64_t name = fields.number(2), extra = fields.number(2), comment = fields.number(2);
  (void)fields.text(8);  // disk, attributes
  member.header = fields.number(4);
  member.name = fields.text(static_cast<std::size_t>(name));
  read_extra(Fields(fields.text(static_cast<std::size_t>(extra)), path), member);
  (void)fields.text(static_cast<std::size_t>(comment));
  if ((flags & kEncrypted) != 0) fail(path, excerpt(member.name) + " is encrypted");
  if (method != kStored && method != kDeflated) {
    fail(path,
         excerpt(member.name) + " is compressed by method " + std::to_string(method) + ", expected none or deflate");
  }
  member.deflated = method == kDeflated;
  if (!member.deflated && member.size != member.packed_size) fail(path, excerpt(member.name) + " has two sizes");
  return member;
}

// Reads through another source.
class CheckedSource final : public ByteSource {
 public:
  CheckedSource(std::unique_ptr<ByteSource> source, std::uint32_t expected, std::string name)
      : source_(std::move(source)), expected_(expected), name_(std::move(name)) {}

  std::size_t read(char* bytes, std::size_t size) override {
    const std::size_t count = source_->read(bytes, size);
    checksum_ = crc32_z(checksum_, reinterpret_cast<const Bytef*>(bytes), count);
    if (count == 0 && checksum_ != expected_) throw InputError(name_ + ": its bytes do not match their checksum");
    return count;
  }
  bool is_checked_at_end() const override { return true; }
  std::optional<std::uint64_t> size() const override { return source_->size(); }
  bool is_seekable() const override { return source_->is_seekable(); }
  void read_at(std::uint64_t offset, char* bytes, std::size_t size) const override {
    source_->read_at(offset, bytes, size);
  }

 private:
  std::unique_ptr<ByteSource> source_;
  uLong checksum_ = 0, expected_;
  std::string name_;
};

}  // namespace

ZipReader::ZipReader(const std::string& path) : path_(path) {
  const std::unique_ptr<ByteSource> file = open_source(path);
  if (!file->size()) throw InputError(path + ": is a ZIP archive on a pipe, expected a regular file");
  read_directory(*file);
}

ZipReader::ZipReader(std::string_view bytes, const std::string& name) : path_(name), in_memory_(bytes) {
  read_directory(*open_bytes(bytes));
}

void ZipReader::read_directory(const ByteSource& file) {
  file_size_ = *file.size();
  const Directory directory = find_directory(file, path_);
  const std::string bytes = bytes_at(file, path_, directory.offset, directory.size);
  Fields fields(bytes, path_);
  while (fields.left() > 0 && members_.size() < directory.entries) members_.push_back(read_entry(fields, path_));
  if (members_.size() != directory.entries) fail(path_, "its directory is damaged");
}

const ZipReader::Member* ZipReader::find(const std::string& name) const {
  const auto found = std::find_if(members_.rbegin(), members_.rend(), [&](const Member& m) { return m.name == name; });
  return found == members_.rend() ? nullptr : &*found;
}

// 4.3.7: name and extra field of the local header may differ from the directory's in length.
std::unique_ptr<ByteSource> ZipReader::open(const Member& member) const {
  constexpr std::uint64_t kHeader = 30;
  const std::unique_ptr<ByteSource> file = in_memory_ ? open_bytes(*in_memory_) : open_source(path_);
  const std::string header = bytes_at(*file, path_, member.header, kHeader);
  Fields fields(header, path_);
  if (fields.number(4) != 0x04034b50) fail(path_, excerpt(member.name) + " is not where the directory says");
  (void)fields.text(22);
  const std::uint64_t name = fields.number(2), extra = fields.number(2);
  const std::uint64_t data = member.header + kHeader + name + extra;
  if (data > file_size_ || member.packed_size > file_size_ - data)
    fail(path_, excerpt(member.name) + " lies beyond its end");
  const auto offset = static_cast<std::size_t>(data), size = static_cast<std::size_t>(member.packed_size);
  std::unique_ptr<ByteSource> part =
      in_memory_ ? open_bytes(in_memory_->substr(offset, size)) : open_part(path_, data, member.packed_size);
  return member.deflated ? inflated(std::move(part), member.size, name_of(member)) : std::move(part);
}

std::string ZipReader::name_of(const Member& member) const { return path_ + ": " + excerpt(member.name); }

std::unique_ptr<ByteSource> ZipReader::open_checked(const Member& member) const {
  return std::make_unique<CheckedSource>(open(member), member.checksum, name_of(member));
}

}  // namespace raycone
