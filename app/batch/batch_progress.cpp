#include "app/batch/batch_progress.h"

#include <unistd.h>

#include <string>
#include <utility>

#include "app/process/messages.h"
#include "app/process/terminal.h"
#include "app/text/readable_count.h"
#include "io/files/counted.h"

namespace raycone {

void BatchProgress::add(MeshStatus status, double part) {
  ++done_;
  failed_ += status == MeshStatus::kOk ? 0 : 1;
  part_ = part;
  if (style_ == Style::kLines && done_ == meshes_) return write_line();
  show();
}

void BatchProgress::show() {
  if (style_ == Style::kRewritten) rewrite();
  if (style_ == Style::kLines && Clock::now() - last_line_ >= between_lines_) write_line();
}

void BatchProgress::rewrite() {
  constexpr std::chrono::milliseconds kBetween{100};  // what changes sooner nobody reads
  const Clock::time_point now = Clock::now();
  if (drawn_ && now - last_line_ < kBetween) return;
  last_line_ = now;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  std::string line = std::to_string(done_) + '/' + counted(meshes_, "mesh");
  if (elapsed > 0.0) line += "  " + readable_count(static_cast<double>(done_) / elapsed, "meshes/s");
  if (part_ > 0.0) line += "  " + readable_time(elapsed * (1.0 - part_) / part_) + " left";
  if (failed_ > 0) line += "  " + std::to_string(failed_) + " failed";
  rewrite_line(line);
  drawn_ = true;
}

void BatchProgress::write_line() {
  last_line_ = Clock::now();
  const double elapsed = std::chrono::duration<double>(last_line_ - start_).count();
  std::string line =
      std::to_string(done_) + '/' + counted(meshes_, "mesh") + ", " + std::to_string(failed_) + " failed";
  if (elapsed > 0.0) line += ", " + readable_count(static_cast<double>(done_) / elapsed, "meshes/s");
  if (part_ > 0.0 && done_ < meshes_) line += ", " + readable_time(elapsed * (1.0 - part_) / part_) + " left";
  print_message(line);
}

void BatchProgress::erase() {
  if (std::exchange(drawn_, false)) erase_line();
}

BatchProgress::Style progress_style(ProgressMode mode) {
  if (!progress_is_shown(mode, "")) return BatchProgress::Style::kNone;
  return isatty(STDERR_FILENO) == 1 ? BatchProgress::Style::kRewritten : BatchProgress::Style::kLines;
}

}  // namespace raycone
