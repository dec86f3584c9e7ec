// ZIP archives of members that are stored, not compressed, all of known size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "io/files/seekable_output.h"

namespace raycone {

struct ZipMember {
  std::string name;        // ASCII
  std::uint64_t size = 0;  // bytes
};

// Members are written side by side. What is beyond 4 GiB takes the form of ZIP64.
// Time stamps are those of 1980-01-01, so that equal members make equal archives.
class ZipWriter {
 public:
  static constexpr std::uint64_t kLargest32 = 0xFFFFFFFF;

  // `output` must outlive the writer. `zip64_from`: the least size or offset that takes the form of ZIP64, which a test
  // may lower.
  ZipWriter(OutputFile& output, const std::vector<ZipMember>& members, std::uint64_t zip64_from = kLargest32);

  // Appends to a member, by its number. Throws OutputError.
  void append(std::size_t member, const void* data, std::size_t size);
  // Writes a piece of a member, from `offset` of it on; pieces come in any order, each byte once. Memory grows with the
  // number of runs of bytes that lie apart.
  void write_at(std::size_t member, std::uint64_t offset, const void* data, std::size_t size);
  // Completes and commits the file; every member must have got all its bytes. Throws OutputError.
  void finish();

 private:
  // Bytes from `begin` on that have been written.
  struct Run {
    std::uint64_t begin = 0;
    std::uint32_t checksum = 0;
  };
  struct Entry {
    std::string name;
    std::uint64_t size = 0;
    std::uint64_t header = 0;  // offset of its local header
    std::uint64_t data = 0;    // offset of its bytes
    std::uint64_t appended = 0;
    std::map<std::uint64_t, Run> runs{};  // by their ends
    std::uint32_t checksum = 0;
  };

  static void join_runs(Entry& entry);
  [[nodiscard]] bool is_large(std::uint64_t number) const { return number >= zip64_from_; }
  [[nodiscard]] std::uint64_t or_largest(std::uint64_t number) const { return is_large(number) ? kLargest32 : number; }
  [[nodiscard]] std::string local_header(const Entry& entry) const;
  [[nodiscard]] std::string directory_entry(const Entry& entry) const;
  [[nodiscard]] std::string end_of_directory(std::uint64_t size) const;

  SeekableOutput output_;
  std::uint64_t zip64_from_;
  std::vector<Entry> entries_;
  std::uint64_t end_ = 0;  // of the last member
};

}  // namespace raycone
