// What the user is told on standard error, and how failures become messages and exit statuses.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "app/process/exit_code.h"

namespace raycone {

// "raycone: ", `message` and a line feed: one line that moves no terminal, whatever bytes its file names
// hold.
[[nodiscard]] std::string message_line(std::string_view message);

// Writes that line to standard error.
void print_message(std::string_view message);

// What limits have done to the work on `name`.
[[nodiscard]] std::string timeout_text(const std::string& name, double seconds);
[[nodiscard]] std::string out_of_memory_text(const std::string& name, std::uint64_t limit);  // bytes

// How a run failed: its exit status, and what to tell the user.
struct Failure {
  ExitCode code = ExitCode::kInternal;
  std::string message;
};

// The exception being handled. Call in a catch block.
[[nodiscard]] Failure current_failure();

// Prints it and returns its exit status.
[[nodiscard]] ExitCode report_current_exception();

}  // namespace raycone
