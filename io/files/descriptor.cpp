#include "io/files/descriptor.h"

#include <fcntl.h>

#include <cerrno>

namespace raycone {

Descriptor open_file(const std::string& path, int flags, mode_t mode) {
  int number = -1;
  do {
    number = open(path.c_str(), flags | O_CLOEXEC, mode);
  } while (number < 0 && errno == EINTR);
  return Descriptor(number);
}

bool write_to_disk(const Descriptor& file) {
  int result = -1;
  do {
    result = fsync(file.number());
  } while (result != 0 && errno == EINTR);
  return result == 0 || errno == EINVAL || errno == ENOSYS;
}

}  // namespace raycone
