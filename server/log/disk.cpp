#include "server/log/disk.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

namespace cycloid::server {
namespace {

int result_of(int returned) {
  return returned == 0 ? 0 : errno;
}

class SystemDisk final : public Disk {
 public:
  int create(const std::string& path, int& file) override {
    file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    return file >= 0 ? 0 : errno;
  }

  bool exists(const std::string& path) override { return ::access(path.c_str(), F_OK) == 0; }

  int write(int file, std::span<const std::byte> bytes, std::size_t& written) override {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0) return errno;
    written = static_cast<std::size_t>(count);
    return 0;
  }

  int sync(int file) override { return result_of(::fdatasync(file)); }
  int close(int file) override { return result_of(::close(file)); }

  /// By a second name, which unlike rename() never replaces a file; where the file system knows no
  /// second names, there is a moment between the look and the rename.
  int rename(const std::string& from, const std::string& to) override {
    if (::link(from.c_str(), to.c_str()) == 0) return result_of(::unlink(from.c_str()));
    if (errno != EPERM && errno != ENOSYS && errno != EOPNOTSUPP && errno != EMLINK) return errno;
    if (exists(to)) return EEXIST;
    return result_of(::rename(from.c_str(), to.c_str()));
  }

  int remove(const std::string& path) override { return result_of(::unlink(path.c_str())); }

  int sync_folder(const std::string& path) override {
    std::error_code error;
    const std::filesystem::path whole = std::filesystem::absolute(path, error);
    if (error) return error.value();
    const int file = ::open(whole.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0 && errno == EACCES) return 0;  // It may be written but not read.
    if (file < 0) return errno;
    const int result = result_of(::fsync(file));
    (void)::close(file);
    return result == EINVAL ? 0 : result;  // A file system that keeps no folders to sync.
  }
};

}  // namespace

std::shared_ptr<Disk> system_disk() {
  static const auto kDisk = std::make_shared<SystemDisk>();
  return kDisk;
}

}  // namespace cycloid::server
