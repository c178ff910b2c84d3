#include "server/host/room_log.hpp"

#include <chrono>
#include <filesystem>
#include <random>
#include <system_error>
#include <utility>

#include "scenes/catalogue.hpp"
#include "server/host/process_time.hpp"

namespace cycloid::server {
namespace {

/// Format 1 of the log cannot go on in another file; its writer then has no such function.
template <class Writer>
ActResult rotate_to(Writer& writer, const std::string& path) {
  if constexpr (requires { writer.rotate(path); }) {
    const std::error_code error = writer.rotate(path);
    return error ? ActResult{409, "rotate: " + path + ": " + error.message()} : ActResult{};
  } else {
    return {501, "rotate: a log of this build begins at tick 0, so it cannot go on in a new file"};
  }
}

/// "ROOM-SECONDS-SALT.log": new for each room, whatever was made before.
std::string new_log_path(const RoomSettings& settings, const std::string& room,
                         std::uint64_t salt) {
  if (settings.log_directory.empty()) return "";
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since_epoch).count();
  std::string name = room;
  for (char& c : name) c = c == ':' ? '-' : c;
  name += "-" + std::to_string(seconds) + "-" + std::to_string(salt & 0xffffff) + ".log";
  return std::filesystem::path(settings.log_directory) / name;
}

std::uint64_t random_number() {
  std::random_device random;
  const std::uint64_t high = random();
  return (high << 32) | random();
}

}  // namespace

std::string another_log_path(const RoomSettings& settings, const std::string& room) {
  return new_log_path(settings, room, random_number());
}

RoomLog::RoomLog(std::unique_ptr<LogWriter> writer, asio::thread_pool& slow)
    : writer_(std::move(writer)), slow_(slow) {}

RoomLog::~RoomLog() = default;

void RoomLog::tick(const protocol::LogTick& tick) {
  if (writer_ != nullptr) writer_->tick(tick);
}

bool RoomLog::wants_keyframe(std::uint64_t tick) const {
  return writer_ != nullptr && writer_->wants_keyframe(tick);
}

void RoomLog::keyframe(std::uint64_t tick, std::uint64_t digest, std::span<const std::byte> state) {
  if (writer_ != nullptr) writer_->keyframe(tick, digest, state);
}

void RoomLog::branch(std::uint64_t tick, std::uint64_t digest) {
  if (writer_ != nullptr) writer_->branch(tick, digest);
}

ActResult RoomLog::rotate(const std::string& path) {
  if (writer_ == nullptr || path.empty()) {
    return {409, "rotate: the room writes no log into a log_directory"};
  }
  return rotate_to(*writer_, path);
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
  header.salt = random_number();
  LogWriterOptions writer;
  writer.path = settings.log.empty() ? new_log_path(settings, room, header.salt) : settings.log;
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
