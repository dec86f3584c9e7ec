// ZIP archives: their members, stored or deflated.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
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
    std::uint64_t header = 0;  // offset of its local header
    bool deflated = false;
  };

  // Reads the directory of the regular file at `path`.
  explicit ZipReader(const std::string& path);

  [[nodiscard]] const std::vector<Member>& members() const { return members_; }
  // Null where there is none.
  [[nodiscard]] const Member* find(const std::string& name) const;

  // The unpacked bytes of a member. Messages about them call it "PATH(NAME)".
  [[nodiscard]] std::unique_ptr<ByteSource> open(const Member& member) const;
  [[nodiscard]] std::string name_of(const Member& member) const { return path_ + '(' + member.name + ')'; }

 private:
  std::string path_;
  std::uint64_t file_size_ = 0;
  std::vector<Member> members_;
};

}  // namespace raycone
