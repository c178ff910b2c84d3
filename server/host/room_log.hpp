#pragma once

#include <asio.hpp>
#include <atomic>
#include <memory>
#include <span>

#include "server/host/act_result.hpp"
#include "server/host/room_settings.hpp"
#include "server/operation/meters.hpp"

namespace cycloid::server {

/// Between a room and the writer of its log: closes the log on another thread, because a close
/// waits for the disk and other rooms share this one.
class RoomLog final : public LogSink {
 public:
  /// @param writer  May be none: then nothing is kept.
  RoomLog(std::unique_ptr<LogWriter> writer, asio::thread_pool& slow);
  RoomLog(const RoomLog&) = delete;
  RoomLog& operator=(const RoomLog&) = delete;
  ~RoomLog() override;

  void tick(const protocol::LogTick& tick) override;
  bool wants_keyframe(std::uint64_t tick) const override;
  void keyframe(std::uint64_t tick, std::uint64_t digest,
                std::span<const std::byte> state) override;
  void branch(std::uint64_t tick, std::uint64_t digest) override;
  /// Returns at once; `settled` says when it is done.
  void close(const protocol::LogFooter& footer) override;
  bool durable() const override { return writer_ == nullptr || writer_->durable(); }
  std::string error() const override { return writer_ == nullptr ? "" : writer_->error(); }
  /// Goes on in a new file. Refused where there is no log, or a log cannot go on in another.
  ActResult rotate(const std::string& path);

  /// Whether nothing more happens on the other thread.
  bool settled() const { return *pending_ == 0; }

 private:
  std::shared_ptr<LogWriter> writer_;
  asio::thread_pool& slow_;
  std::shared_ptr<std::atomic<int>> pending_ = std::make_shared<std::atomic<int>>(0);
};

/// Opens the log that the settings ask for; none where they ask for none.
/// @throws std::system_error where the file exists already or cannot be made.
std::unique_ptr<LogWriter> open_room_log(const RoomSettings& settings, const std::string& room,
                                         const LogCalls& calls);

/// A file of its own for the room in the log directory; "" where there is none.
std::string another_log_path(const RoomSettings& settings, const std::string& room);

/// The same calls, with the time of each sync counted. `meters` is kept.
LogCalls metered(LogCalls calls, std::shared_ptr<HostMeters> meters);

}  // namespace cycloid::server
