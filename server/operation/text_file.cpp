#include "server/operation/text_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace cycloid::server {
namespace {

/// False where it cannot be read to its end, or that is too far.
bool read_to_end(int descriptor, std::string& text) {
  char part[4096];
  for (;;) {
    const ssize_t bytes = ::read(descriptor, part, sizeof part);
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes <= 0) return bytes == 0;
    text.append(part, static_cast<std::size_t>(bytes));
    if (text.size() > kTextFileBytesMax) return false;
  }
}

}  // namespace

std::optional<std::string> read_text_file(const std::string& path) {
  // O_NONBLOCK, or the open would wait for somebody who writes into a pipe.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return std::nullopt;
  struct stat status {};
  std::string text;
  const bool whole =
      ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && read_to_end(descriptor, text);
  (void)::close(descriptor);
  if (!whole) return std::nullopt;
  return text;
}

}  // namespace cycloid::server
