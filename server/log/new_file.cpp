#include "server/log/new_file.hpp"

#include <cerrno>

namespace cycloid::server {

int write_new_file(Disk& disk, const std::string& path, std::span<const std::byte> bytes) {
  int file = -1;
  if (const int error = disk.create(path, file)) return error;
  int error = 0;
  for (std::size_t done = 0; error == 0 && done < bytes.size();) {
    std::size_t written = 0;
    error = disk.write(file, bytes.subspan(done), written);
    if (error == EINTR) error = 0;
    done += written;
  }
  if (error == 0) error = disk.sync(file);
  const int close_error = disk.close(file);
  if (error == 0) error = close_error;
  if (error != 0) (void)disk.remove(path);
  return error;
}

}  // namespace cycloid::server
