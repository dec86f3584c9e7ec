#include "io/files/spool_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include "io/files/file_buffer.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

constexpr std::size_t kCopySize = std::size_t{1} << 20;

[[noreturn]] void fail_to_spool(const std::string& name, int error) {
  throw OutputError(name + ": cannot write: temporary file: " + std::generic_category().message(error));
}

std::FILE* open_unlinked(const std::string& name) {
  std::FILE* file = std::tmpfile();
  if (file == nullptr) fail_to_spool(name, errno);
  return file;
}

}  // namespace

struct SpoolFile::State {
  explicit State(const std::string& output_name)
      : name(output_name), file(open_unlinked(name), &std::fclose), buffer(fileno(file.get())), stream(&buffer) {}

  std::string name;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file;
  FileBuffer buffer;
  std::ostream stream;
};

SpoolFile::SpoolFile(const std::string& name) : state_(std::make_unique<State>(name)) {}
SpoolFile::~SpoolFile() = default;

std::ostream& SpoolFile::stream() { return state_->stream; }

void SpoolFile::copy_to(OutputFile& output) {
  read_back([&output](const char* data, std::size_t size) { output.write(data, size); });
}

void SpoolFile::read_back(const std::function<void(const char*, std::size_t)>& take) {
  if (state_->buffer.pubsync() != 0) fail_to_spool(state_->name, state_->buffer.error());
  const int descriptor = fileno(state_->file.get());
  if (lseek(descriptor, 0, SEEK_SET) < 0) fail_to_spool(state_->name, errno);
  const auto bytes = std::make_unique_for_overwrite<char[]>(kCopySize);
  while (true) {
    const ssize_t count = read(descriptor, bytes.get(), kCopySize);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_to_spool(state_->name, errno);
    if (count == 0) return;
    take(bytes.get(), static_cast<std::size_t>(count));
  }
}

}  // namespace raycone
