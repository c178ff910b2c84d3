#include "server/log/log_file.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

namespace cycloid::server {

LogFile::LogFile(std::shared_ptr<Disk> disk, std::string path, std::string temporary_name)
    : disk_(std::move(disk)), path_(std::move(path)), temporary_name_(std::move(temporary_name)) {}

LogFile::~LogFile() {
  if (file_ < 0) return;
  (void)disk_->close(file_);
  if (!published_) (void)disk_->remove(temporary_name_);
}

bool LogFile::fail(const char* what, int code) {
  code_ = code;
  error_ = path_ + ": " + what + ": " + std::generic_category().message(code);
  return false;
}

bool LogFile::create() {
  if (disk_->exists(path_)) return fail("create", EEXIST);
  const int code = disk_->create(temporary_name_, file_);
  if (code != 0) file_ = -1;
  return code == 0 || fail("create", code);
}

bool LogFile::append(std::span<const std::byte> bytes) {
  while (code_ == 0 && !bytes.empty()) {
    std::size_t written = 0;
    const int code = disk_->write(file_, bytes, written);
    if (code == EINTR) continue;
    if (code != 0) return fail("write", code);
    if (written == 0) return fail("write", EIO);  // It takes nothing, and says no error either.
    bytes = bytes.subspan(written);
  }
  return code_ == 0;
}

bool LogFile::sync() {
  if (code_ != 0) return false;
  int code = EINTR;
  while (code == EINTR) code = disk_->sync(file_);
  return code == 0 || fail("sync", code);
}

bool LogFile::publish() {
  if (!sync()) return false;
  if (const int code = disk_->rename(temporary_name_, path_); code != 0)
    return fail("rename", code);
  published_ = true;
  const int code = disk_->sync_folder(path_);
  return code == 0 || fail("sync of the folder", code);
}

}  // namespace cycloid::server
