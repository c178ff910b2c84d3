#include "server/host/room_log.hpp"

#include <chrono>
#include <filesystem>
#include <system_error>
#include <utility>

#include "protocol/build_text.hpp"
#include "server/host/process_time.hpp"
#include "server/log/random_number.hpp"

namespace cycloid::server {
namespace {

std::int64_t unix_now_ns() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch).count();
}

}  // namespace

RoomLogPlace room_log_place(const RoomSettings& settings, const std::string& room,
                            std::shared_ptr<Disk> disk) {
  return {room, settings.log, settings.log_directory, settings.log_sync, std::move(disk)};
}

RoomLog::RoomLog(RoomLogPlace place, protocol::LogHeader header, asio::thread_pool& slow)
    : place_(std::move(place)), header_(std::move(header)), slow_(slow) {
  header_.log_id = random_number();
  header_.salt = random_number();
  header_.start_unix_ns = unix_now_ns();
  header_.build = protocol::build_text();
  header_.room = place_.room;
  const std::string path = place_.path.empty() ? new_path(header_.salt) : place_.path;
  if (!path.empty()) open(path, nullptr);
}

RoomLog::~RoomLog() = default;

/// "ROOM-SECONDS-SALT.cylog": new for each, whatever was made before, and found by `verify FOLDER`.
std::string RoomLog::new_path(std::uint64_t salt) const {
  if (place_.directory.empty()) return "";
  std::string name = place_.room;
  for (char& c : name) c = c == ':' ? '-' : c;
  name += "-" + std::to_string(unix_now_ns() / 1'000'000'000) + "-" +
          std::to_string(salt & 0xffffff) + ".cylog";
  return std::filesystem::path(place_.directory) / name;
}

/// "MATCH-from-TICK-SALT.cylog" beside the first file, "MATCH.cylog".
std::string RoomLog::branch_path() const {
  if (!place_.directory.empty()) return new_path(header_.salt);
  std::filesystem::path path = place_.path;
  const std::string name = path.stem().string() + "-from-" + std::to_string(header_.branch_tick) +
                           "-" + std::to_string(header_.salt & 0xffffff);
  return path.replace_filename(name + path.extension().string()).string();
}

void RoomLog::open(const std::string& path, const protocol::LogKeyframe* first) {
  LogWriterOptions options;
  options.path = path;
  options.sync = place_.sync;
  options.disk = place_.disk;
  writer_ = std::make_shared<LogWriter>(std::move(options), header_, first);
}

void RoomLog::tick(const protocol::LogTick& tick) {
  if (writer_ == nullptr) return;
  writer_->tick(tick);
  last_ = {tick.frame.tick, tick.digest, {}};
}

bool RoomLog::wants_keyframe(std::uint64_t tick) const {
  return writer_ != nullptr && writer_->wants_keyframe(tick);
}

void RoomLog::keyframe(std::uint64_t tick, std::uint64_t digest, std::span<const std::byte> state) {
  if (writer_ != nullptr) writer_->keyframe(tick, digest, state);
}

void RoomLog::branch(const protocol::LogTick& from, std::span<const std::byte> state) {
  if (writer_ == nullptr) return;
  header_.parent_log_id = writer_->log_id();  // A rotation has given it another than `header_`'s.
  const std::string ended = error();
  close_writer(last_);
  if (!ended.empty()) {
    writer_ = nullptr;
    branch_error_ = ended;
    return;
  }
  header_.log_id = random_number();
  header_.salt = random_number();
  header_.branch_tick = from.frame.tick;
  header_.start_unix_ns = unix_now_ns();
  const protocol::LogKeyframe first{
      from.frame.tick, from.digest, from.frame.seats, {state.begin(), state.end()}};
  last_ = {from.frame.tick, from.digest, {}};
  try {
    open(branch_path(), &first);
  } catch (const std::system_error& failure) {
    writer_ = nullptr;
    branch_error_ = failure.what();
  }
}

ActResult RoomLog::rotate() {
  const std::string path = new_path(random_number());
  if (writer_ == nullptr || path.empty()) {
    return {409, "rotate: the room writes no log into a log_directory"};
  }
  const std::error_code error = writer_->rotate(path);
  if (!error) return {};
  const bool is_under_way = error == std::errc::device_or_resource_busy;
  return {is_under_way ? 409 : kCannotWrite, "rotate: " + path + ": " + error.message()};
}

void RoomLog::close(const protocol::LogFooter& footer) {
  if (writer_ != nullptr) close_writer(footer);
}

void RoomLog::close_writer(const protocol::LogFooter& footer) {
  ++closing_->pending;
  auto work = [writer = writer_, footer, closing = closing_] {
    writer->close(footer);
    if (!writer->durable()) {
      const std::scoped_lock lock(closing->mutex);
      if (closing->error.empty()) closing->error = writer->error();
    }
    --closing->pending;
  };
  asio::post(slow_, std::move(work));
}

std::string RoomLog::closing_error() const {
  const std::scoped_lock lock(closing_->mutex);
  return closing_->error;
}

bool RoomLog::durable() const {
  const bool goes_on = branch_error_.empty() && (writer_ == nullptr || writer_->durable());
  return goes_on && closing_error().empty();
}

std::string RoomLog::error() const {
  if (!branch_error_.empty()) return branch_error_;
  if (std::string closing = closing_error(); !closing.empty()) return closing;
  return writer_ == nullptr ? "" : writer_->error();
}

namespace {

class MeteredDisk final : public Disk {
 public:
  MeteredDisk(std::shared_ptr<Disk> disk, std::shared_ptr<HostMeters> meters)
      : disk_(std::move(disk)), meters_(std::move(meters)) {}

  int create(const std::string& path, int& file) override { return disk_->create(path, file); }
  bool exists(const std::string& path) override { return disk_->exists(path); }
  int write(int file, std::span<const std::byte> bytes, std::size_t& written) override {
    return disk_->write(file, bytes, written);
  }
  int sync(int file) override {
    const std::int64_t begin_ns = process_now_ns();
    const int result = disk_->sync(file);
    meters_->log_sync.add(static_cast<std::uint64_t>(process_now_ns() - begin_ns));
    return result;
  }
  int close(int file) override { return disk_->close(file); }
  int rename(const std::string& from, const std::string& to) override {
    return disk_->rename(from, to);
  }
  int remove(const std::string& path) override { return disk_->remove(path); }
  int sync_folder(const std::string& path) override { return disk_->sync_folder(path); }

 private:
  std::shared_ptr<Disk> disk_;
  std::shared_ptr<HostMeters> meters_;
};

}  // namespace

std::shared_ptr<Disk> metered(std::shared_ptr<Disk> disk, std::shared_ptr<HostMeters> meters) {
  return std::make_shared<MeteredDisk>(std::move(disk), std::move(meters));
}

}  // namespace cycloid::server
