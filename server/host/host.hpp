#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "server/host/gatehouse.hpp"
#include "server/host/hosted_room.hpp"
#include "server/net/listener.hpp"

namespace cycloid::server {

/// What may change while the host runs.
struct HostLimits {
  std::size_t rooms_max = 256;
  Limits room;  ///< Of every room.
};

struct NamedRoom {
  std::string name;
  RoomSettings settings;
};

struct HostOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any.
  int threads = 1;         ///< That make the ticks and move the bytes; @pre 1 to 64.
  bool realtime = false;   ///< Ask for SCHED_FIFO and locked memory; goes on without.
  bool catch_signals = true;
  /// From the first SIGTERM or SIGINT to the end of the rooms; a second one ends them at once.
  std::chrono::milliseconds drain{0};
  bool ends_with_last_room = false;  ///< Else it waits for more.
  SocketOptions sockets;
  GateOptions gate;
  std::shared_ptr<ServerTls> tls;  ///< None: TCP alone.
  HostLimits limits;
  std::vector<NamedRoom> rooms;                   ///< Made before the first connection.
  std::map<std::string, RoomTemplate> templates;  ///< What others are made of.
  std::shared_ptr<Disk> disk = system_disk();     ///< Of the logs.
  std::string desync_directory;                   ///< For reports of desyncs; none: a line each.
  std::shared_ptr<spdlog::logger> logger;         ///< None: lines on stderr.
  std::function<void()> on_reload;                ///< SIGHUP; on a thread beside the pool.
};

struct HostReport {
  std::map<std::string, ServeReport> rooms;  ///< The first 1,024 that have ended, by name.
  std::uint64_t rooms_ended = 0;
  std::uint64_t refusals = 0;    ///< At the gate.
  std::uint64_t gate_bytes = 0;  ///< Heard there: hellos.
  bool good = true;              ///< All rooms ended by a drain or after their ticks, and durable.
};

/// Many rooms on a fixed pool of threads.
///
/// One io_context runs on all threads; every room is a strand of it, so it is on one thread at a
/// time, and rooms share nothing but this directory. The directory's lock is held for look-ups
/// only, and never by a tick. Rooms are made and logs are closed on a thread beside the pool.
class Host {
 public:
  /// Binds the address and makes the configured rooms; the address first: where it cannot be had,
  /// no log is left behind.
  /// @throws std::system_error and std::invalid_argument, as HostedRoom and Listener do.
  explicit Host(HostOptions options);
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;
  ~Host();

  std::uint16_t port() const { return listener_->port(); }
  /// Runs the pool until all is over. Rethrows what a thread threw.
  HostReport run(std::stop_token stop = {});

  // Any thread:

  /// Makes a room. `done` is called on the accept strand once it is there, or cannot be.
  void make_room(const std::string& name, const std::string& of_template, HostedRoom::Done done);
  /// None, or a room, which must not outlive the host.
  std::shared_ptr<HostedRoom> find(const std::string& name) const;
  std::vector<std::shared_ptr<HostedRoom>> rooms() const;  ///< By name.
  /// Nobody comes in any more, and the rooms end after `deadline` or when they are empty. Asked
  /// again, the nearest deadline counts.
  void drain(const std::string& reason, std::chrono::milliseconds deadline);
  /// All rooms end now.
  void end(const std::string& reason);
  bool draining() const { return draining_; }
  /// Stopped once `run` has ended: what was asked of a room and not answered by then never is.
  std::stop_token over() const { return over_.get_token(); }
  /// "", or which room has not made a tick for so many ticks though one was due.
  std::string stuck(std::uint32_t ticks_max) const;
  void set_limits(const HostLimits& limits);
  /// Of `gate` what `Gate::set_limits` takes.
  void set_gate_limits(const GateOptions& gate);
  void set_token_keys(std::vector<PublicKey> keys);
  void set_drain(std::chrono::milliseconds drain) { drain_ms_ = drain.count(); }
  /// How long a drain lasts that names no deadline.
  std::chrono::milliseconds drain_time() const { return std::chrono::milliseconds(drain_ms_); }
  const HostMeters& meters() const { return *meters_; }
  const std::shared_ptr<spdlog::logger>& logger() const { return options_.logger; }

 private:
  void start_rooms();
  void run_pool();
  void run_thread();
  void wait_for_signal();
  /// What the gate is told of a name.
  RoomVerdict judge(const std::string& wanted, const Admission& admission) const;
  std::shared_ptr<HostedRoom> find_or_only(const std::string& wanted) const;
  bool makes_on_join(const std::string& wanted) const;
  void on_admitted(Entrant entrant);
  void join_new_room(const std::string& name, Entrant entrant);
  /// Those who waited for the room: into it, or away with what `made` says.
  void let_joiners_in(const std::string& name, const ActResult& made);
  ActResult reserve(const std::string& name, const std::string& of_template, RoomSettings& settings,
                    std::uint32_t& slot);
  void build(const std::string& name, RoomSettings settings, std::uint32_t slot,
             HostedRoom::Done done);
  void gone(const std::string& name, const ServeReport& report);
  void forget(const std::string& name, std::uint32_t slot);
  void finish_if_over();
  RoomSite site();

  HostOptions options_;
  std::shared_ptr<HostMeters> meters_ = std::make_shared<HostMeters>();
  asio::io_context io_;
  asio::thread_pool slow_{2};
  std::shared_ptr<ReportSink> reports_;
  scenes::StepMemories step_memories_;
  Gatehouse::Strand accept_strand_;
  asio::signal_set signals_;
  std::optional<Gatehouse> gatehouse_;
  std::optional<Listener> listener_;
  std::int64_t epoch_ns_ = 0;
  std::atomic<bool> draining_{false};
  std::int64_t drain_at_ns_ = 0;  ///< On the accept strand, while it drains.
  int signals_heard_ = 0;         ///< Likewise; those that end the process.
  std::atomic<std::int64_t> drain_ms_;
  std::map<std::string, std::vector<Entrant>> joining_;  ///< Rooms that are being made for them.
  RefillBucket cannot_lines_{kClientLines, 0};  ///< Of rooms that joiners asked for in vain.

  mutable std::mutex directory_mutex_;
  std::map<std::string, std::shared_ptr<HostedRoom>> directory_;  ///< None: still being made.
  std::set<std::uint32_t> slots_;
  HostLimits limits_;  ///< Under the directory's lock.
  HostReport report_;  ///< Likewise.

  std::stop_source over_;
  std::mutex thrown_mutex_;
  std::exception_ptr thrown_;
};

}  // namespace cycloid::server
