#include "app/process/messages.h"

#include <cstdio>
#include <exception>
#include <new>

#include "app/process/usage_error.h"
#include "app/text/plain_text.h"
#include "io/files/ascii.h"
#include "io/files/file_error.h"
#include "io/files/readable_bytes.h"

namespace raycone {

std::string message_line(std::string_view message) { return "raycone: " + plain_text(message, "?") + '\n'; }

void print_message(std::string_view message) { std::fputs(message_line(message).c_str(), stderr); }

std::string timeout_text(const std::string& name, double seconds) {
  const std::string limit = with_digits(seconds, 6) + (seconds == 1.0 ? " second" : " seconds");
  return name + ": not finished within " + limit + " (--timeout)";
}

std::string out_of_memory_text(const std::string& name, std::uint64_t limit) {
  return name + ": out of memory, the limit is " + readable_bytes(static_cast<double>(limit));
}

Failure current_failure() {
  try {
    throw;
  } catch (const UsageError& error) {
    return {ExitCode::kUsage, error.what()};
  } catch (const InputError& error) {
    return {ExitCode::kInput, error.what()};
  } catch (const OutputError& error) {
    return {ExitCode::kOutput, error.what()};
  } catch (const LimitError& error) {
    return {ExitCode::kLimit, error.what()};
  } catch (const std::bad_alloc&) {
    return {ExitCode::kLimit, "out of memory"};
  } catch (const std::exception& error) {
    return {ExitCode::kInternal, std::string("internal error, please report: ") + error.what()};
  } catch (...) {
    return {ExitCode::kInternal, "internal error, please report"};
  }
}

ExitCode report_current_exception() {
  const Failure failure = current_failure();
  print_message(failure.message);
  return failure.code;
}

}  // namespace raycone
