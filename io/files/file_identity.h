// Which file a name stands for.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

namespace raycone {

// Equal for two names of one file, be they links, other spellings of its path or, as standard input or output, no name
// at all. A file that is yet to be made has no inode: it is known by its directory and its name there, in lower case,
// because file systems that do not tell cases apart would make one file of two such names.
struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;       // the directory's where `new_name` is not empty
  std::string new_name;  // empty where the file exists

  friend bool operator==(const FileIdentity&, const FileIdentity&) = default;
};

// Of what is read from `path` ("-": standard input) or written to it ("-": standard output). Nothing for all that
// cannot be overwritten: pipes, devices but disks, directories, and what is not there.
[[nodiscard]] std::optional<FileIdentity> identity_of_input(const std::string& path);
[[nodiscard]] std::optional<FileIdentity> identity_of_output(const std::string& path);

// Whether two names of outputs ("-": standard output) are one pipe.
[[nodiscard]] bool are_one_pipe(const std::string& path, const std::string& other);

// `path` with symbolic links in its last component followed, also a dangling one, as far as a descriptor's name.
[[nodiscard]] std::string follow_links(std::string path);

// "-", or a name of descriptor 0: what can be read once.
[[nodiscard]] bool is_standard_input(const std::string& path);

// The number N of /dev/fd/N and /proc/self/fd/N: descriptors that the caller opened for us.
[[nodiscard]] std::optional<int> descriptor_number(const std::string& path);

// "." for a name without a directory.
[[nodiscard]] std::string directory_of(const std::string& path);

}  // namespace raycone
