// ZIP archives: their members, stored or deflated.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/byte_source.h"

namespace raycone {

// Throws InputError about the archive wherever it is damaged, encrypted or compressed in another way. ZIP64 is read;
// archives in several parts are not.
class ZipReader {
 public:
  struct Member {
    std::string name;
    std::uint64_t size = 0;  // unpacked, as announced
    std::uint64_t packed_size = 0;
    std::uint64_t header = 0;    // offset of its local header
    std::uint32_t checksum = 0;  // CRC-32 of the unpacked bytes, which open() does not compare
    bool deflated = false;
  };

  // Reads the directory of the regular file at `path`.
  explicit ZipReader(const std::string& path);
  // Of an archive in memory, which must outlive this; messages call it `name`.
  ZipReader(std::string_view bytes, const std::string& name);

  [[nodiscard]] const std::vector<Member>& members() const { return members_; }
  // The last one of that name, which replaces others in archives that were appended to. Null where there is none.
  [[nodiscard]] const Member* find(const std::string& name) const;

  // The unpacked bytes of a member. Messages about them call it "PATH: NAME".
  [[nodiscard]] std::unique_ptr<ByteSource> open(const Member& member) const;
  // The same, to be read from start to end: there they are compared with the checksum. read_at() compares nothing.
  [[nodiscard]] std::unique_ptr<ByteSource> open_checked(const Member& member) const;
  [[nodiscard]] std::string name_of(const Member& member) const;

 private:
  void read_directory(const ByteSource& file);

  std::string path_;
  std::optional<std::string_view> in_memory_;
  std::uint64_t file_size_ = 0;
  std::vector<Member> members_;
};

}  // namespace raycone
