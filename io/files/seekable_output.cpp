#include "io/files/seekable_output.h"

namespace raycone {

SeekableOutput::SeekableOutput(OutputFile& output) : output_(output) {
  if (!output.seekable()) spool_.emplace(output.name());
}

std::ostream& SeekableOutput::stream() { return spool_ ? spool_->stream() : output_.stream(); }

void SeekableOutput::write_at(std::uint64_t offset, const void* data, std::size_t size) {
  std::ostream& to = stream();
  to.seekp(static_cast<std::streamoff>(offset));
  to.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  if (!to && !spool_) output_.flush();  // throws, with the reason
}

void SeekableOutput::commit() {
  if (spool_) spool_->copy_to(output_);
  output_.commit();
}

}  // namespace raycone
