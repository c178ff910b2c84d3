#include "cli/sim/log_disk.hpp"

#include <algorithm>
#include <cerrno>

namespace cycloid::sim {
namespace {

int errno_of(DiskError error) {
  switch (error) {
    case DiskError::kNone:
      return 0;
    case DiskError::kInterrupted:
      return EINTR;
    case DiskError::kInputOutput:
      return EIO;
    case DiskError::kNoSpace:
      return ENOSPC;
  }
  return EIO;
}

}  // namespace

int LogDisk::create(const std::string& path, int& file) {
  if (exists(path)) return EEXIST;
  file = static_cast<int>(handles_.size());
  handles_.push_back({path, {}, 0, false});
  return 0;
}

bool LogDisk::exists(const std::string& path) {
  return std::any_of(handles_.begin(), handles_.end(),
                     [&](const Handle& one) { return one.path == path; });
}

int LogDisk::write(int file, std::span<const std::byte> bytes, std::size_t& written) {
  Handle& into = handle(file);
  written = bytes.size();
  if (is_cut_off_) return 0;
  if (!into.is_named) {
    into.unnamed.insert(into.unnamed.end(), bytes.begin(), bytes.end());
    return 0;
  }
  const DiskWrite wrote = disk_->write(into.number, bytes);
  written = wrote.bytes;
  return errno_of(wrote.error);
}

int LogDisk::sync(int file) {
  const Handle& synced = handle(file);
  if (is_cut_off_ || !synced.is_named) return 0;
  const bool lies = plant_ == Plant::kLogForgetsSync;
  const DiskError error = lies ? DiskError::kNone : disk_->sync(synced.number);
  if (error == DiskError::kNone) ++syncs_;
  return errno_of(error);
}

int LogDisk::close(int) {
  return 0;
}

int LogDisk::rename(const std::string& from, const std::string& to) {
  if (exists(to)) return EEXIST;
  const auto named = std::find_if(handles_.begin(), handles_.end(),
                                  [&](const Handle& one) { return one.path == from; });
  if (named == handles_.end()) return ENOENT;
  named->path = to;
  named->is_named = true;
  named->number = first_file_ + files_.size();
  if (is_cut_off_ || disk_->killed()) return 0;
  disk_->create(named->number, named->unnamed);
  files_.push_back(named->number);
  return 0;
}

int LogDisk::remove(const std::string& path) {
  for (Handle& one : handles_)
    if (one.path == path) one.path.clear();
  return 0;
}

int LogDisk::sync_folder(const std::string&) {
  return 0;
}

}  // namespace cycloid::sim
