#include "client/join.hpp"

#include <asio.hpp>
#include <memory>
#include <utility>

#include "client/net/connection.hpp"
#include "client/replica/replica.hpp"
#include "client/replica/thin.hpp"

namespace cycloid::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPingInterval{500};

std::unique_ptr<Follower> make_follower(const JoinOptions& options, scenes::Simulation simulation) {
  FollowerOptions follower;
  follower.scene_digest = scenes::scene_digest(options.scene);
  follower.seat_wish = options.seat_wish;
  follower.name = options.name;
  follower.input = options.input;
  if (!follower.input) {
    follower.input = [&scene = options.scene](int seat, std::uint64_t tick) {
      return scenes::scripted_input(scene, seat, tick);
    };
  }
  if (options.mode == protocol::Mode::kSnapshot) {
    return std::make_unique<Thin>(std::move(simulation), std::move(follower));
  }
  return std::make_unique<Replica>(std::move(simulation), std::move(follower));
}

/// One visit of a room: the follower says what, the connection carries it.
class Visit {
 public:
  Visit(const JoinOptions& options, scenes::Simulation simulation)
      : options_(options),
        follower_(make_follower(options, std::move(simulation))),
        connection_(io_, {options.connect, options.silence}, handlers()) {}

  JoinReport run() {
    connection_.open(options_.host, options_.port);
    io_.run();
    report_.progress = follower_->progress();
    report_.final_digest = follower_->simulation().digest();
    report_.bytes_in = connection_.bytes_in();
    report_.bytes_out = connection_.bytes_out();
    return report_;
  }

 private:
  Connection::Handlers handlers() {
    return {[this] { greet(); },
            [this](const protocol::ServerMessage& message) { receive(message); },
            [this] { poll(); },
            [this](const std::string& reason) {
              if (!left_) leave(End::kDisconnected, reason);
            }};
  }

  void greet() {
    opened_ = pinged_ = Clock::now();
    open_ = true;
    follower_->greet(outbox_);
    flush();
  }

  void receive(const protocol::ServerMessage& message) {
    if (left_) return;
    follower_->receive(message, outbox_);
    flush();
    if (options_.on_progress) options_.on_progress(*follower_);

    const Progress& progress = follower_->progress();
    if (progress.phase == Phase::kEnded) return leave(End::kBye, progress.reason);
    if (progress.phase == Phase::kRefused) return leave(End::kRefused, progress.reason);
    if (progress.phase == Phase::kFailed) return leave(End::kFailed, progress.reason);
    if (options_.ticks != 0 && progress.snapshots != 0 &&
        progress.last_tick - progress.first_tick >= options_.ticks) {
      leave(End::kTicks, "all ticks seen");
    }
  }

  void poll() {
    if (left_) return;
    if (options_.should_stop && options_.should_stop()) return leave(End::kStopped, "told to stop");
    if (!open_) return;
    const auto now = Clock::now();
    if (follower_->progress().snapshots == 0 && now - opened_ > options_.handshake) {
      return leave(End::kDisconnected, "no welcome in time");
    }
    if (now - pinged_ < kPingInterval) return;
    pinged_ = now;
    follower_->ping(outbox_);
    flush();
  }

  void flush() {
    for (const protocol::ClientMessage& message : outbox_) connection_.send(message);
    outbox_.clear();
  }

  /// The first end is the one that counts.
  void leave(End end, const std::string& reason) {
    if (left_) return;
    left_ = true;
    report_.end = end;
    report_.reason = reason;
    const bool our_choice = end == End::kTicks || end == End::kStopped || end == End::kFailed;
    if (our_choice && open_) connection_.send(protocol::Bye{reason});
    connection_.finish(reason);
  }

  const JoinOptions& options_;
  std::unique_ptr<Follower> follower_;
  asio::io_context io_{1};
  Connection connection_;
  Outbox outbox_;
  JoinReport report_;
  Clock::time_point opened_;
  Clock::time_point pinged_;
  bool open_ = false;
  bool left_ = false;
};

}  // namespace

const char* end_name(End end) {
  switch (end) {
    case End::kTicks:
      return "ticks";
    case End::kBye:
      return "bye";
    case End::kStopped:
      return "stopped";
    case End::kRefused:
      return "refused";
    case End::kDisconnected:
      return "disconnected";
    case End::kFailed:
      return "failed";
  }
  return "unknown";
}

JoinReport join(const JoinOptions& options) {
  auto simulation = scenes::Simulation::create(options.scene);
  JoinReport report;
  if (!simulation.ok()) {
    report.reason = std::string("the scene cannot run: ") + simulation.error().field;
    return report;
  }
  if (const solver::Error error = simulation.value().set_workers(options.workers); !error.ok()) {
    report.reason = std::string("the scene cannot run: ") + error.field;
    return report;
  }
  return Visit(options, std::move(simulation.value())).run();
}

}  // namespace cycloid::client
