#pragma once

#include <asio.hpp>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "protocol/log/values.hpp"
#include "server/host/act_result.hpp"
#include "server/host/room_settings.hpp"
#include "server/operation/meters.hpp"

namespace cycloid::server {

/// Where the log of a room goes, and by which disk.
struct RoomLogPlace {
  std::string room;
  std::string path;       ///< The first file; "": one of `directory`.
  std::string directory;  ///< For a file of its own for every room, rotation and branch; "": none.
  LogSync sync = LogSync::kInterval;
  std::shared_ptr<Disk> disk;
};

RoomLogPlace room_log_place(const RoomSettings& settings, const std::string& room,
                            std::shared_ptr<Disk> disk);

/// Between a room and the writer of its log: closes files on another thread, because a close waits
/// for the disk and other rooms share this one. All calls are the room's, on its strand.
class RoomLog final : public LogSink {
 public:
  /// Opens the log where the place names one.
  /// @param header  With the scene and its rate; ids, times and the build are filled in.
  /// @throws std::system_error where the file exists already or cannot be made.
  RoomLog(RoomLogPlace place, protocol::LogHeader header, asio::thread_pool& slow);
  RoomLog(const RoomLog&) = delete;
  RoomLog& operator=(const RoomLog&) = delete;
  ~RoomLog() override;

  void tick(const protocol::LogTick& tick) override;
  bool wants_keyframe(std::uint64_t tick) const override;
  void keyframe(std::uint64_t tick, std::uint64_t digest,
                std::span<const std::byte> state) override;
  /// Closes the file and goes on in one that names it as its parent. Where that cannot be made the
  /// log has ended; one that has ended before does not begin anew.
  void branch(const protocol::LogTick& from, std::span<const std::byte> state) override;
  /// Returns at once; `settled` says when it is done.
  void close(const protocol::LogFooter& footer) override;
  bool durable() const override;
  std::string error() const override;
  /// Goes on in a new file of the directory. Refused where there is none.
  ActResult rotate();

  /// Whether there is a file, or was one. Where there never was, a room needs no log at all.
  bool kept() const { return writer_ != nullptr || !branch_error_.empty(); }
  /// Whether nothing more happens on the other thread.
  bool settled() const { return closing_->pending == 0; }

 private:
  /// Shared with the other thread.
  struct Closing {
    std::atomic<int> pending{0};
    std::mutex mutex;
    std::string error;  ///< The first of a file that was closed.
  };

  std::string new_path(std::uint64_t salt) const;
  std::string branch_path() const;
  void open(const std::string& path, const protocol::LogKeyframe* first);
  void close_writer(const protocol::LogFooter& footer);
  std::string closing_error() const;

  RoomLogPlace place_;
  protocol::LogHeader header_;
  asio::thread_pool& slow_;
  std::shared_ptr<LogWriter> writer_;
  protocol::LogFooter last_;  ///< The tick that the writer's file has come to.
  std::string branch_error_;
  std::shared_ptr<Closing> closing_ = std::make_shared<Closing>();
};

/// The same disk, with the time of each sync counted.
std::shared_ptr<Disk> metered(std::shared_ptr<Disk> disk, std::shared_ptr<HostMeters> meters);

}  // namespace cycloid::server
