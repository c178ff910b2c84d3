#include "server/host/room_log.hpp"

#include <chrono>
#include <filesystem>
#include <random>
#include <utility>

#include "scenes/catalogue.hpp"
#include "server/host/process_time.hpp"

namespace cycloid::server {
namespace {

/// "ROOM-SECONDS-SALT.log": new for each room, whatever was made before.
std::string log_path(const RoomSettings& settings, const std::string& room, std::uint64_t salt) {
  if (!settings.log.empty() || settings.log_directory.empty()) return settings.log;
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since_epoch).count();
  std::string name = room;
  for (char& c : name) c = c == ':' ? '-' : c;
  name += "-" + std::to_string(seconds) + "-" + std::to_string(salt & 0xffffff) + ".log";
  return std::filesystem::path(settings.log_directory) / name;
}

}  // namespace

RoomLog::RoomLog(std::unique_ptr<LogWriter> writer, RoomMeters& meters, asio::thread_pool& slow)
    : writer_(std::move(writer)), meters_(meters), slow_(slow) {}

RoomLog::~RoomLog() = default;

void RoomLog::tick(const protocol::LogTick& tick) {
  std::uint64_t replaced = 0;
  for (const protocol::SeatFrame& seat : tick.frame.seats) {
    replaced += seat.origin == protocol::Origin::kRepeated ? 1 : 0;
    replaced += seat.origin == protocol::Origin::kNeutral ? 1 : 0;
  }
  if (replaced > 0) meters_.inputs_replaced.add(replaced);
  if (writer_ != nullptr) writer_->tick(tick);
}

void RoomLog::close(const protocol::LogFooter& footer) {
  if (writer_ == nullptr) return;
  ++*pending_;
  auto work = [writer = writer_, footer, pending = pending_] {
    writer->close(footer);
    --*pending;
  };
  asio::post(slow_, std::move(work));
}

std::unique_ptr<LogWriter> open_room_log(const RoomSettings& settings, const std::string& room,
                                         const LogCalls& calls) {
  if (settings.log.empty() && settings.log_directory.empty()) return nullptr;
  protocol::LogHeader header;
  header.scene_digest = scenes::scene_digest(settings.scene);
  header.scene_name = settings.scene_name;
  header.scene = scenes::to_binary(settings.scene);
  std::random_device random;
  header.salt = random();
  header.salt = (header.salt << 32) | random();
  LogWriterOptions writer;
  writer.path = log_path(settings, room, header.salt);
  writer.sync = settings.log_sync;
  writer.calls = calls;
  return std::make_unique<LogWriter>(std::move(writer), header);
}

LogCalls metered(LogCalls calls, std::shared_ptr<HostMeters> meters) {
  calls.sync = [sync = std::move(calls.sync), meters = std::move(meters)](int file) {
    const std::int64_t begin_ns = process_now_ns();
    const int result = sync(file);
    meters->log_sync.add(static_cast<std::uint64_t>(process_now_ns() - begin_ns));
    return result;
  };
  return calls;
}

}  // namespace cycloid::server
