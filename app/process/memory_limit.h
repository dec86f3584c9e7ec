// Memory: what this process may use, and what it does use.
#pragma once

#include <cstdint>
#include <string>

namespace raycone {

// The least of: what `ulimit -v` leaves to this process, what `ulimit -d` does, and seven eighths of what the machine
// and the cgroup leave to so many processes, divided among them. Bytes.
[[nodiscard]] std::uint64_t available_memory(std::uint64_t processes = 1);

// Makes allocations fail with std::bad_alloc before more than `bytes` are resident in this process, code and libraries
// included. What is mapped at the time of the call and was never touched, such as stacks of threads that run, is taken
// to stay so, but for the end of the heap; so are `untouched` bytes that are yet to be mapped. Never more than
// `ulimit -d` allowed at the start. Lets heaps grow in steps, of 32 MB each where there is plenty, of less with many
// threads.
void cap_memory(std::uint64_t bytes, double untouched = 0.0);

// Largest resident size so far, in bytes.
[[nodiscard]] std::uint64_t peak_memory();

// Bytes that are resident now, with what code and stacks will take yet.
[[nodiscard]] double memory_in_use();

// Throws LimitError with both numbers if `more` bytes on top of memory_in_use() exceed `limit`. `name`: the file
// concerned.
void check_memory(const std::string& name, double more, std::uint64_t limit);

}  // namespace raycone
