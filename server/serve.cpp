#include "server/serve.hpp"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <asio.hpp>
#include <cmath>
#include <csignal>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "server/net/listener.hpp"
#include "server/net/rethrow.hpp"
#include "server/room/room.hpp"

namespace cycloid::server {
namespace {

using Clock = std::chrono::steady_clock;

/// Connections that the room has refused and that still read why, beside those it has.
constexpr std::size_t kLeavingMax = 64;
constexpr std::chrono::milliseconds kLeavingPoll{10};
/// Of a message, more than a snapshot has beside its state.
constexpr std::size_t kSnapshotBytesBeside = 1024;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
      .count();
}

scenes::Simulation make_simulation(const ServeOptions& options) {
  auto simulation = scenes::Simulation::create(options.scene);
  solver::Error error = simulation.error();
  if (simulation.ok()) error = simulation.value().set_workers(options.workers);
  if (!error.ok()) {
    throw std::invalid_argument(std::string("the scene cannot run: ") +
                                solver::code_name(error.code) + " " + error.field);
  }
  std::vector<std::byte> state;
  simulation.value().encode(state);
  if (state.size() > protocol::kServerMessageBytesMax - kSnapshotBytesBeside) {
    throw std::invalid_argument("the scene is too large: a snapshot of " +
                                std::to_string(state.size()) + " bytes");
  }
  return std::move(simulation.value());
}

std::unique_ptr<LogWriter> make_log(const ServeOptions& options) {
  if (options.log.empty()) return nullptr;
  protocol::LogHeader header;
  header.scene_digest = scenes::scene_digest(options.scene);
  header.scene_name = options.scene_name;
  header.scene = scenes::to_binary(options.scene);
  std::random_device random;
  header.salt = random();
  header.salt = (header.salt << 32) | random();
  LogWriterOptions writer;
  writer.path = options.log;
  writer.sync = options.log_sync;
  return std::make_unique<LogWriter>(std::move(writer), header);
}

RoomOptions room_options(const ServeOptions& options, const scenes::Simulation& simulation) {
  RoomOptions room;
  room.limits = options.limits;
  room.scene_digest = scenes::scene_digest(options.scene);
  room.tick_rate_millihertz = options.tick_rate_millihertz;
  if (room.tick_rate_millihertz == 0) {
    const double rate = 1000.0 / static_cast<double>(simulation.tick_s());
    room.tick_rate_millihertz = static_cast<std::uint32_t>(std::lround(rate));
  }
  room.ticks = options.ticks;
  room.stop_on_log_error = options.stop_on_log_error;
  return room;
}

/// One line for each event that matters, on stderr: stdout belongs to the program's report.
spdlog::logger make_logger() {
  return spdlog::logger("cycloid", std::make_shared<spdlog::sinks::stderr_sink_mt>());
}

spdlog::level::level_enum level_of(Notice::Kind kind) {
  switch (kind) {
    case Notice::Kind::kJoin:
    case Notice::Kind::kLeave:
    case Notice::Kind::kEnd:
    case Notice::Kind::kAct:
      return spdlog::level::info;
    case Notice::Kind::kRefusal:
    case Notice::Kind::kDesync:
    case Notice::Kind::kOverload:
      return spdlog::level::warn;
    case Notice::Kind::kFault:
    case Notice::Kind::kLog:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

/// Where room, log and network meet.
class Host {
 public:
  explicit Host(const ServeOptions& options)
      : options_(options),
        logger_(make_logger()),
        simulation_(make_simulation(options)),
        io_(1),
        timer_(io_),
        signals_(io_) {}

  ServeReport run(const std::function<void(std::uint16_t)>& on_listening, std::stop_token stop) {
    open();
    if (options_.catch_signals) {
      signals_.add(SIGINT);
      signals_.add(SIGTERM);
      wait_for_signal();
    }
    logger_.info("listening at {} port {}", options_.address, listener_->port());
    if (on_listening) on_listening(listener_->port());

    asio::co_spawn(
        io_, [this] { return tick_loop(); }, rethrow);
    {
      const std::stop_callback on_stop(
          stop, [this] { asio::post(io_, [this] { drain("told to stop"); }); });
      io_.run();
    }
    return report();
  }

 private:
  /// The address first: where it cannot be had, no log is left behind.
  void open() {
    const auto trouble = [this](const std::string& why) {
      logger_.warn("cannot accept connections: {}; trying again, said once", why);
    };
    listener_.emplace(io_, options_.address, options_.port,
                      options_.limits.connections_max + kLeavingMax, trouble);
    log_ = make_log(options_);
    const RoomOptions options = room_options(options_, *simulation_);
    const auto notice = [this](const Notice& said) { logger_.log(level_of(said.kind), said.text); };
    room_.emplace(options, std::move(*simulation_), RoomHooks{now_ns, notice, log_.get()});
    listener_->start(*room_);
  }

  void wait_for_signal() {
    signals_.async_wait([this](const asio::error_code& error, int signal) {
      if (error) return;
      if (room_->state() != RoomState::kRunning) return io_.stop();  // Asked twice: at once.
      wait_for_signal();
      drain(signal == SIGINT ? "SIGINT" : "SIGTERM");
    });
  }

  void drain(const std::string& reason) {
    room_->drain(reason);
    timer_.cancel();
  }

  asio::awaitable<void> tick_loop() {
    asio::error_code error;
    auto done = asio::redirect_error(asio::use_awaitable, error);
    while (room_->state() == RoomState::kRunning) {
      const std::chrono::nanoseconds deadline(room_->next_deadline_ns());
      timer_.expires_at(Clock::time_point(std::chrono::duration_cast<Clock::duration>(deadline)));
      co_await timer_.async_wait(done);
      room_->advance();
      listener_->wake_all();
    }
    listener_->close();
    while (listener_->busy()) {  // At most as long as a session lingers.
      timer_.expires_after(kLeavingPoll);
      co_await timer_.async_wait(done);
    }
    signals_.cancel();
  }

  ServeReport report() const {
    const RoomStatistics& statistics = room_->statistics();
    ServeReport report;
    switch (room_->state()) {
      case RoomState::kRunning:
      case RoomState::kDrained:
        report.end = End::kDrained;
        break;
      case RoomState::kTicksDone:
        report.end = End::kTicks;
        break;
      case RoomState::kFaulted:
        report.end = End::kFaulted;
        break;
      case RoomState::kLogFailed:
        report.end = End::kLogError;
        break;
    }
    report.reason = room_->end_reason();
    report.ticks = room_->tick();
    report.final_digest = room_->digest();
    report.worst_tick_ns = statistics.worst_tick_ns;
    report.lateness_p99_ns = statistics.lateness_ns.quantile(990);
    report.bytes_in = statistics.bytes_in;
    report.bytes_out = statistics.bytes_out;
    report.desyncs = statistics.desyncs;
    report.clients = statistics.clients;
    report.refusals = statistics.refusals;
    report.inputs_late = statistics.inputs_late;
    report.slowed_ns = statistics.slowed_ns;
    report.durable = log_ == nullptr || log_->durable();
    return report;
  }

  const ServeOptions& options_;
  spdlog::logger logger_;
  std::optional<scenes::Simulation> simulation_;  ///< Until the room has it.
  std::unique_ptr<LogWriter> log_;
  std::optional<Room> room_;
  asio::io_context io_;  ///< After the room, which the sessions in its handlers refer to.
  asio::steady_timer timer_;
  asio::signal_set signals_;
  std::optional<Listener> listener_;
};

}  // namespace

const char* end_name(End end) {
  switch (end) {
    case End::kDrained:
      return "drained";
    case End::kTicks:
      return "ticks";
    case End::kFaulted:
      return "faulted";
    case End::kLogError:
      return "log error";
  }
  return "unknown";
}

ServeReport serve(const ServeOptions& options,
                  const std::function<void(std::uint16_t port)>& on_listening,
                  std::stop_token stop) {
  return Host(options).run(on_listening, std::move(stop));
}

}  // namespace cycloid::server
