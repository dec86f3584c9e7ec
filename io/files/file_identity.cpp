#include "io/files/file_identity.h"
#include "io/files/ascii.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <climits>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

namespace raycone {
namespace {

// Where the symbolic link `path` points to; nothing for all else.
std::optional<std::string> link_target(const std::string& path) {
  std::array<char, PATH_MAX> target;
  const ssize_t length = readlink(path.c_str(), target.data(), target.size());
  if (length < 0) return std::nullopt;
  const std::string text(target.data(), static_cast<std::size_t>(length));
  return text.starts_with('/') ? text : directory_of(path) + '/' + text;
}

std::optional<FileIdentity> identity_of(const struct stat& status) {
  if (!S_ISREG(status.st_mode) && !S_ISBLK(status.st_mode)) return std::nullopt;
  return FileIdentity{status.st_dev, status.st_ino, ""};
}

}  // namespace

std::optional<FileIdentity> identity_of_input(const std::string& path) {
  struct stat status {};
  const int result = path == "-" ? fstat(STDIN_FILENO, &status) : stat(path.c_str(), &status);
  return result == 0 ? identity_of(status) : std::nullopt;
}

std::optional<FileIdentity> identity_of_output(const std::string& path) {
  struct stat status {};
  if ((path == "-" ? fstat(STDOUT_FILENO, &status) : stat(path.c_str(), &status)) == 0) return identity_of(status);
  if (path == "-") return std::nullopt;
  const std::string target = follow_links(path);
  if (stat(directory_of(target).c_str(), &status) != 0) return std::nullopt;
  return FileIdentity{status.st_dev, status.st_ino, lower_case(target.substr(target.rfind('/') + 1))};
}

bool are_one_pipe(const std::string& path, const std::string& other) {
  const auto status_of = [](const std::string& name) {
    struct stat status {};
    const int result = name == "-" ? fstat(STDOUT_FILENO, &status) : stat(name.c_str(), &status);
    return result == 0 && S_ISFIFO(status.st_mode) ? std::optional(std::pair(status.st_dev, status.st_ino))
                                                   : std::nullopt;
  };
  const auto pipe = status_of(path);
  return pipe && pipe == status_of(other);
}

std::string follow_links(std::string path) {
  constexpr int kMaxLinks = 40;  // the kernel's own limit
  for (int i = 0; i < kMaxLinks && !descriptor_number(path); ++i) {
    std::optional<std::string> target = link_target(path);
    if (!target) break;
    path = std::move(*target);
  }
  return path;
}

std::optional<int> descriptor_number(const std::string& path) {
  for (const std::string_view prefix : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!path.starts_with(prefix)) continue;
    const std::string_view digits = std::string_view(path).substr(prefix.size());
    int number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error == std::errc() && end == digits.data() + digits.size() && number >= 0) return number;
  }
  return std::nullopt;
}

bool is_standard_input(const std::string& path) {
  return path == "-" || descriptor_number(follow_links(path)) == STDIN_FILENO;
}

std::string directory_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : path.substr(0, std::max<std::size_t>(slash, 1));
}

}  // namespace raycone
