#include "app/process/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

namespace raycone {

std::size_t terminal_columns(int descriptor) {
  winsize size{};
  return isatty(descriptor) != 0 && ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

void rewrite_line(std::string_view line) {
  const std::size_t columns = terminal_columns(STDERR_FILENO);
  if (columns > 0) line = line.substr(0, columns - 1);
  std::fprintf(stderr, "\r\033[K%.*s", static_cast<int>(line.size()), line.data());
  std::fflush(stderr);
}

void erase_line() { std::fputs("\r\033[K", stderr); }

}  // namespace raycone
