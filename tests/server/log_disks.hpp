#pragma once

#include <algorithm>
#include <cerrno>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "protocol/log_format.hpp"
#include "server/log/disk.hpp"

namespace cycloid::server {

/// The system's disk, but for what a test puts in the place of a call.
class ScriptedDisk : public Disk {
 public:
  std::function<int(int, std::span<const std::byte>, std::size_t&)> on_write;
  std::function<int(int)> on_sync;

  int create(const std::string& path, int& file) override { return real_->create(path, file); }
  bool exists(const std::string& path) override { return real_->exists(path); }
  int write(int file, std::span<const std::byte> bytes, std::size_t& written) override {
    return on_write ? on_write(file, bytes, written) : real_->write(file, bytes, written);
  }
  int sync(int file) override { return on_sync ? on_sync(file) : real_->sync(file); }
  int close(int file) override { return real_->close(file); }
  int rename(const std::string& from, const std::string& to) override {
    return real_->rename(from, to);
  }
  int remove(const std::string& path) override { return real_->remove(path); }
  int sync_folder(const std::string& path) override { return real_->sync_folder(path); }

 private:
  std::shared_ptr<Disk> real_ = system_disk();
};

/// A disk in memory, for one thread, that is full at some point.
class MemoryDisk final : public Disk {
 public:
  std::map<std::string, std::vector<std::byte>> files;
  std::map<std::string, std::size_t> synced_bytes;  ///< That a loss of power leaves of each file.
  std::size_t room_bytes = std::numeric_limits<std::size_t>::max();
  int full_error = ENOSPC;
  std::size_t write_bytes_max = std::numeric_limits<std::size_t>::max();
  int interrupts_every = 0;  ///< Writes between two that are interrupted; 0: never.
  int syncs_until_error = -1;
  int syncs = 0;

  int create(const std::string& path, int& file) override {
    if (files.contains(path)) return EEXIST;
    files[path];
    names_.push_back(path);
    file = static_cast<int>(names_.size()) - 1;
    return 0;
  }
  bool exists(const std::string& path) override { return files.contains(path); }
  int write(int file, std::span<const std::byte> bytes, std::size_t& written) override {
    if (interrupts_every != 0 && ++writes_ % interrupts_every == 0) return EINTR;
    written = std::min({bytes.size(), room_bytes, write_bytes_max});
    if (written == 0) return full_error;
    room_bytes -= written;
    std::vector<std::byte>& to = files.at(names_.at(static_cast<std::size_t>(file)));
    to.insert(to.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(written));
    return 0;
  }
  int sync(int file) override {
    if (syncs++ == syncs_until_error) return EIO;
    const std::string& name = names_.at(static_cast<std::size_t>(file));
    synced_bytes[name] = files.at(name).size();
    return 0;
  }
  int close(int) override { return 0; }
  int rename(const std::string& from, const std::string& to) override {
    if (files.contains(to)) return EEXIST;
    files[to] = files.at(from);
    files.erase(from);
    synced_bytes[to] = synced_bytes[from];
    synced_bytes.erase(from);
    for (std::string& name : names_)
      if (name == from) name = to;
    return 0;
  }
  int remove(const std::string& path) override { return files.erase(path) == 1 ? 0 : ENOENT; }
  int sync_folder(const std::string&) override { return 0; }

 private:
  std::vector<std::string> names_;
  int writes_ = 0;
};

/// Made of its number alone, so that a reader knows what it must be.
inline protocol::LogTick numbered_tick(std::uint64_t tick) {
  protocol::LogTick made;
  made.frame.tick = tick;
  made.frame.seats.resize(2);
  made.frame.seats[tick % 2].input.axes[tick % 4] = static_cast<std::int16_t>(tick * 7919);
  made.frame.seats[0].origin = protocol::Origin::kGiven;
  if (tick % 50 == 1) made.frame.events = {{protocol::EventKind::kJoin, 1}};
  made.digest = tick * 0x9e3779b97f4a7c15u;
  return made;
}

inline std::vector<std::byte> numbered_state(std::uint64_t tick) {
  return std::vector<std::byte>(200 + tick % 1000, static_cast<std::byte>(tick));
}

/// Empty, or in what the log is not a good prefix of the ticks by their numbers.
inline std::string wrong_in(const protocol::Log& log) {
  using protocol::LogState;
  if (log.state == LogState::kCorrupt || log.state == LogState::kIncompatible) return log.reason;
  std::uint64_t number = log.header.branch_tick;
  for (const protocol::LogTick& tick : log.ticks) {
    const protocol::LogTick expected = numbered_tick(++number);
    if (tick.frame != expected.frame || tick.digest != expected.digest)
      return "tick " + std::to_string(number) + " is another";
  }
  return "";
}

}  // namespace cycloid::server
