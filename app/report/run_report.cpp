// One line per message, its wording made where the cause is known.
#include "app/report/run_report.h"

#include <cstdio>
#include <exception>
#include <new>

#include "app/process/usage_error.h"
#include "app/text/plain_text.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// "1 face", "2 faces"
std::string counted(std::uint64_t count, const std::string& singular) {
  return std::to_string(count) + " " + singular + (count == 1 ? "" : "s");
}

std::string verification_clause(const Verification& verification) {
  char difference[64];
  std::snprintf(difference, sizeof difference, ", largest difference %.2g", verification.largest_difference);
  std::string clause = ", verified " + counted(verification.samples, "sample") + difference;
  if (verification.largest_distance_difference) {
    std::snprintf(difference, sizeof difference, " (of distances %.2g)", *verification.largest_distance_difference);
    clause += difference;
  }
  if (verification.unresolved > 0) clause += ", skipped " + std::to_string(verification.unresolved) + " unresolved";
  return clause;
}

}  // namespace

std::string summary_line(const RunReport& report) {
  const Seconds& s = report.seconds;
  char times[160];
  std::snprintf(times, sizeof times, " in %.2f s (read %.2f, prepare %.2f, evaluate %.2f, write %.2f) -> ", s.total,
                s.read, s.prepare, s.evaluate, s.write);
  return report.mesh + ": " + counted(report.faces, "face") + ", " + counted(report.exterior_edges, "exterior edge") +
         ", " + counted(report.samples, "sample") + times + (report.output == "-" ? "standard output" : report.output) +
         (report.verification ? verification_clause(*report.verification) : "");
}

std::string message_line(std::string_view message) { return "raycone: " + plain_text(message, "?") + '\n'; }

void print_message(std::string_view message) { std::fputs(message_line(message).c_str(), stderr); }

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
