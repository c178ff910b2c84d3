#pragma once

#include <spdlog/logger.h>

#include <asio.hpp>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/admission/refill_bucket.hpp"
#include "server/desync/report_sink.hpp"
#include "server/desync/room_inquiry.hpp"
#include "server/host/act_result.hpp"
#include "server/host/life_cycle.hpp"
#include "server/host/room_log.hpp"
#include "server/host/room_report.hpp"
#include "server/host/room_settings.hpp"
#include "server/net/session.hpp"
#include "server/operation/meters.hpp"

namespace cycloid::server {

/// Lines of a room's log that clients cause: who joins, leaves or is refused in a loop fills no
/// disk.
inline constexpr Rate kClientLines{5, 20};

/// What hosted rooms need of their host, which outlives them.
struct RoomSite {
  asio::io_context& io;
  asio::thread_pool& slow;  ///< For what waits for a disk.
  std::shared_ptr<HostMeters> meters;
  std::shared_ptr<spdlog::logger> logger;
  std::shared_ptr<Disk> disk;           ///< Of the logs.
  std::shared_ptr<ReportSink> reports;  ///< Of desyncs; none: they are a line each.
  scenes::StepMemories step_memories;   ///< Of all rooms: those that wait hold none.
  std::int64_t epoch_ns = 0;            ///< Where the rasters of all rooms begin.
  /// A connection that cannot come in, and why. Any thread.
  std::function<void(Entrant, const protocol::Refused&)> turn_away;
  /// The room is over and nothing of it runs any more. Any thread.
  std::function<void(const std::string& name, const ServeReport&)> gone;
};

/// Says the result to whoever asked for it.
inline void answer(const std::function<void(ActResult)>& done, ActResult result) {
  if (done) done(std::move(result));
}

/// A room with its strand, its clock, its log and its sessions.
///
/// Everything of it runs on the strand, so on one thread at a time; public functions are for any
/// thread and hand over to it. Others see it through its meters, for which it never waits.
class HostedRoom : public std::enable_shared_from_this<HostedRoom> {
 public:
  /// Makes the world and the log, which may take long.
  /// @param slot  Gives the phase of its ticks; see `phase_of_slot`.
  /// @throws std::invalid_argument where the scene cannot run, and std::system_error where the log
  /// cannot be made.
  HostedRoom(RoomSite site, std::string name, RoomSettings settings, std::uint32_t slot);
  HostedRoom(const HostedRoom&) = delete;
  HostedRoom& operator=(const HostedRoom&) = delete;

  /// The first tick is due at the next moment of the room's phase.
  void start();
  void enter(Entrant entrant);

  using Done = std::function<void(ActResult)>;
  /// `done` is called on some thread; it may be empty. kDrain and kEnd tell the clients `reason`.
  void act(LifeAct act, std::string reason, std::chrono::milliseconds deadline, Done done);
  /// One that drains ends within this time, if that is sooner; of another nothing changes.
  void hasten_drain(std::string reason, std::chrono::milliseconds deadline);
  /// Takes the seat from whoever holds it.
  void kick(std::uint16_t seat, std::string reason, Done done);
  /// Keeps the seat for an identity, or, where that is "", for a token bound to the seat, until so
  /// many more ticks are made. @pre the seat exists and ticks > 0.
  void reserve(std::uint16_t seat, std::string identity, std::uint64_t ticks, Done done);
  /// Writes the exact state of the last tick to a file, which must be new.
  void write_snapshot(std::string path, Done done);
  /// The match goes on from an earlier tick.
  void rewind(std::uint64_t tick, Done done);
  /// Ends the log's file as it is and goes on in a new one.
  void rotate_log(Done done);
  void set_limits(const Limits& limits);
  /// Ends at once, and gives nobody time to read the last word.
  void hurry(std::string reason);

  const std::string& name() const { return name_; }
  std::uint32_t slot() const { return slot_; }
  int seats() const { return seats_; }
  const std::string& scene_name() const { return settings_.scene_name; }
  const RoomMeters& meters() const { return meters_; }
  LifeStage stage() const { return shown_stage_; }
  bool locked() const { return shown_locked_; }
  /// Why this newcomer may not come in, if so. The room may be over by the time that they do.
  std::optional<protocol::Refused> closed(const Admission& admission) const;

 private:
  std::optional<protocol::Refused> full(const Admission& admission) const;
  void open_room();
  RoomInquiryHooks inquiry_hooks();
  void on_tick();
  void arm();
  void arm_at(std::int64_t process_ns);
  void settle(std::int64_t now_ns);
  void drain_within(std::chrono::milliseconds deadline, const std::string& reason);
  void end(const std::string& reason);
  void wait_for_last();
  void wake_sessions();
  void publish();
  void publish_stage();
  void ask(Done done, std::function<ActResult(Room&)> question);
  void take_notice(const Notice& notice);
  void show_places();
  void admit(Entrant entrant);
  ServeReport report() const;
  std::int64_t tick_ns() const;

  RoomSite site_;
  std::string name_;
  RoomSettings settings_;
  std::uint32_t slot_;
  std::uint32_t rate_millihertz_ = 0;
  int seats_ = 0;
  RoomStrand strand_;
  asio::steady_timer timer_;
  RoomMeters meters_;
  std::optional<scenes::Simulation> simulation_;  ///< Until the room has it.
  std::unique_ptr<RoomLog> log_;
  std::int64_t start_ns_ = 0;  ///< The room's time stands here until then.
  LifeCycle life_;
  std::unique_ptr<RoomInquiry> inquiry_;  ///< Before the room, which calls it.
  std::optional<Room> room_;
  std::vector<std::weak_ptr<Session>> sessions_;
  std::int64_t drain_at_ns_ = 0;
  std::string drain_reason_;
  std::int64_t empty_since_ns_ = 0;
  bool hurries_ = false;
  std::atomic<LifeStage> shown_stage_{LifeStage::kRunning};
  std::atomic<bool> shown_locked_{false};
  std::atomic<bool> shown_seats_full_{false};  ///< As of the last tick, join or leave.
  std::atomic<bool> shown_full_{false};        ///< Of connections, likewise.
  RefillBucket lines_{kClientLines, 0};
  std::uint64_t lines_left_out_ = 0;
};

}  // namespace cycloid::server
