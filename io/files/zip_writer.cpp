// Numbers of sections are those of PKWARE's APPNOTE.TXT 6.3.10. Written here because libzip, minizip and their like
// want the bytes of one member after the other, and know their own places for time stamps.
#include "io/files/zip_writer.h"

#include <zlib.h>

#include <stdexcept>
#include <utility>

namespace raycone {
namespace {

constexpr std::uint16_t kFirstDay = (1 << 5) | 1;  // 1980-01-01, in the DOS format

// Fields in the order in which they are appended, little-endian.
class Record {
 public:
  Record& u16(std::uint64_t value) { return append(value, 2); }
  Record& u32(std::uint64_t value) { return append(value, 4); }
  Record& u64(std::uint64_t value) { return append(value, 8); }
  Record& text(const std::string& text) {
    bytes_ += text;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  Record& append(std::uint64_t value, int size) {
    for (int n = 0; n < size; ++n) bytes_ += static_cast<char>(value >> (8 * n) & 0xFF);
    return *this;
  }

  std::string bytes_;
};

// Signature to length of the name: what local header and directory entry have in common. `size`: as the record has it.
Record& append_common(Record& record, bool zip64, std::uint32_t checksum, std::uint64_t size, const std::string& name) {
  constexpr std::uint64_t kFlags = 0, kStored = 0, kMidnight = 0;
  return record.u16(zip64 ? 45 : 20)
      .u16(kFlags)
      .u16(kStored)
      .u16(kMidnight)
      .u16(kFirstDay)
      .u32(checksum)
      .u32(size)
      .u32(size)
      .u16(name.size());
}

std::uint32_t checksum_of(std::uint32_t before, const void* data, std::size_t size) {
  return static_cast<std::uint32_t>(crc32_z(before, static_cast<const Bytef*>(data), size));
}

}  // namespace

// 4.3.7; a size that does not fit stands in the ZIP64 extra field, 4.5.3.
std::string ZipWriter::local_header(const Entry& entry) const {
  Record extra;
  if (is_large(entry.size)) extra.u16(1).u16(16).u64(entry.size).u64(entry.size);
  Record record;
  append_common(record.u32(0x04034b50), is_large(entry.size), entry.checksum, or_largest(entry.size), entry.name);
  return record.u16(extra.bytes().size()).text(entry.name).text(extra.bytes()).bytes();
}

// 4.3.12
std::string ZipWriter::directory_entry(const Entry& entry) const {
  Record large;
  if (is_large(entry.size)) large.u64(entry.size).u64(entry.size);
  if (is_large(entry.header)) large.u64(entry.header);
  const bool zip64 = !large.bytes().empty();
  Record extra;
  if (zip64) extra.u16(1).u16(large.bytes().size()).text(large.bytes());
  constexpr std::uint64_t kMadeBy = 45, kNoComment = 0, kFirstDisk = 0, kNoAttributes = 0;
  Record record;
  append_common(record.u32(0x02014b50).u16(kMadeBy), zip64, entry.checksum, or_largest(entry.size), entry.name);
  return record.u16(extra.bytes().size())
      .u16(kNoComment)
      .u16(kFirstDisk)
      .u16(kNoAttributes)
      .u32(kNoAttributes)
      .u32(or_largest(entry.header))
      .text(entry.name)
      .text(extra.bytes())
      .bytes();
}

// 4.3.14 to 4.3.16: what follows the directory of `size` bytes at end_.
std::string ZipWriter::end_of_directory(std::uint64_t size) const {
  constexpr std::uint64_t kDisk = 0, kDisks = 1, kVersion = 45, kRestOfRecord = 44, kNoComment = 0;
  const std::uint64_t entries = entries_.size();
  Record record;
  if (is_large(end_) || is_large(size)) {
    record.u32(0x06064b50).u64(kRestOfRecord).u16(kVersion).u16(kVersion).u32(kDisk).u32(kDisk);
    record.u64(entries).u64(entries).u64(size).u64(end_);
    record.u32(0x07064b50).u32(kDisk).u64(end_ + size).u32(kDisks);
  }
  record.u32(0x06054b50).u16(kDisk).u16(kDisk).u16(entries).u16(entries);
  return record.u32(or_largest(size)).u32(or_largest(end_)).u16(kNoComment).bytes();
}

ZipWriter::ZipWriter(OutputFile& output, const std::vector<ZipMember>& members, std::uint64_t zip64_from)
    : output_(output), zip64_from_(zip64_from) {
  for (const ZipMember& member : members) {
    Entry entry{.name = member.name, .size = member.size, .header = end_};
    entry.data = end_ + local_header(entry).size();
    end_ = entry.data + entry.size;
    entries_.push_back(std::move(entry));
  }
}

void ZipWriter::append(std::size_t member, const void* data, std::size_t size) {
  Entry& entry = entries_[member];
  write_at(member, entry.appended, data, size);
  entry.appended += size;
}

void ZipWriter::write_at(std::size_t member, std::uint64_t offset, const void* data, std::size_t size) {
  if (size == 0) return;  // zlib takes a null pointer for a request to begin
  Entry& entry = entries_[member];
  output_.write_at(entry.data + offset, data, size);
  Run run{offset, 0};
  if (const auto before = entry.runs.find(offset); before != entry.runs.end()) {
    run = before->second;
    entry.runs.erase(before);
  }
  run.checksum = checksum_of(run.checksum, data, size);
  entry.runs[offset + size] = run;
}

// The checksum of all bytes, from those of the runs.
void ZipWriter::join_runs(Entry& entry) {
  std::uint64_t end = 0;
  for (const auto& [run_end, run] : entry.runs) {
    if (run.begin != end) break;
    const auto length = static_cast<z_off_t>(run_end - run.begin);
    entry.checksum = static_cast<std::uint32_t>(crc32_combine(entry.checksum, run.checksum, length));
    end = run_end;
  }
  if (end != entry.size) throw std::logic_error("a ZIP member has another size than announced");
}

void ZipWriter::finish() {
  std::string directory;
  for (Entry& entry : entries_) {
    join_runs(entry);
    const std::string header = local_header(entry);
    output_.write_at(entry.header, header.data(), header.size());
    directory += directory_entry(entry);
  }
  const std::string tail = directory + end_of_directory(directory.size());
  output_.write_at(end_, tail.data(), tail.size());
  output_.commit();
}

}  // namespace raycone
