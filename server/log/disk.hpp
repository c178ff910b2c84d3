#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace cycloid::server {

/// The few things that a log asks of a disk, so that a simulated one can stand in its place. Every
/// call returns 0 or an errno value. One thread at a time for one file.
class Disk {
 public:
  virtual ~Disk() = default;
  /// A new file to append to; EEXIST where the name is taken.
  virtual int create(const std::string& path, int& file) = 0;
  virtual bool exists(const std::string& path) = 0;
  /// May take less than all, or EINTR; `written` counts only where 0 is returned.
  virtual int write(int file, std::span<const std::byte> bytes, std::size_t& written) = 0;
  /// Returns when the bytes and the size are on the disk.
  virtual int sync(int file) = 0;
  /// The file is closed whatever is returned.
  virtual int close(int file) = 0;
  /// Gives a file its name; EEXIST, and nothing has changed, where that is taken.
  virtual int rename(const std::string& from, const std::string& to) = 0;
  virtual int remove(const std::string& path) = 0;
  /// Returns when the names in the folder of this file are on the disk.
  virtual int sync_folder(const std::string& path) = 0;
};

/// That of the system, by POSIX calls. For any thread.
std::shared_ptr<Disk> system_disk();

}  // namespace cycloid::server
