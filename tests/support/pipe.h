// What is written to a pipe.
#pragma once

#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace raycone::test {

// All that write(path) writes to a pipe of that path, which is read meanwhile. `write` must not throw.
template <class Write>
std::string received_through_pipe(const Write& write) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
  std::string received;
  std::thread reader([&] {
    std::vector<char> bytes(65536);
    for (ssize_t count; (count = read(ends[0], bytes.data(), bytes.size())) > 0;) {
      received.append(bytes.data(), static_cast<std::size_t>(count));
    }
  });
  write("/dev/fd/" + std::to_string(ends[1]));
  close(ends[1]);
  reader.join();
  close(ends[0]);
  return received;
}

}  // namespace raycone::test
