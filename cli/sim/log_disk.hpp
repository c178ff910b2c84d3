#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cli/sim/disk.hpp"
#include "cli/sim/plant.hpp"
#include "server/log/disk.hpp"

namespace cycloid::sim {

/// The simulated disk as the writer of a room's log sees it. A file has its faults once it has its
/// name: a server whose log cannot begin does not start, which is no matter of a run.
class LogDisk final : public server::Disk {
 public:
  /// @param first_file  Its files have this number on `disk` and those behind it.
  LogDisk(SimDisk& disk, std::uint64_t first_file, Plant plant)
      : disk_(&disk), first_file_(first_file), plant_(plant) {}

  int create(const std::string& path, int& file) override;
  bool exists(const std::string& path) override;
  int write(int file, std::span<const std::byte> bytes, std::size_t& written) override;
  int sync(int file) override;
  int close(int file) override;
  int rename(const std::string& from, const std::string& to) override;
  int remove(const std::string& path) override;
  int sync_folder(const std::string& path) override;

  /// The process is gone: nothing that it still tries has any effect.
  void cut_off() { is_cut_off_ = true; }

  /// By their numbers on the disk, the oldest first.
  const std::vector<std::uint64_t>& files() const { return files_; }
  std::uint64_t syncs() const { return syncs_; }  ///< That went well, of named files.

 private:
  struct Handle {
    std::string path;
    protocol::Bytes unnamed;  ///< What was written before it had its name.
    std::uint64_t number = 0;
    bool is_named = false;
  };
  Handle& handle(int file) { return handles_[static_cast<std::size_t>(file)]; }

  SimDisk* disk_;
  std::uint64_t first_file_;
  Plant plant_;
  std::vector<Handle> handles_;
  std::vector<std::uint64_t> files_;
  std::uint64_t syncs_ = 0;
  bool is_cut_off_ = false;
};

}  // namespace cycloid::sim
