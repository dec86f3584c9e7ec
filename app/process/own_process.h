// Processes that are raycone itself, started anew for work that may end them.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

namespace raycone {

// Exit statuses of one that did not get as far as its work: it lacked memory to start. Also the dynamic linker's, which
// lacks a library, too.
inline constexpr int kNotStarted = 127;
// Likewise, for another reason: its file may not be executed, as in shells.
inline constexpr int kNotExecuted = 126;

// Starts this executable with `words` behind its name, and returns its process, which is killed when the calling thread
// ends. `prepare` is called in it before: it arranges descriptors and signals, by async-signal-safe calls only. Throws
// std::system_error where there can be no other process.
[[nodiscard]] pid_t start_anew(const std::vector<std::string>& words, const std::function<void()>& prepare);

}  // namespace raycone
