#include "client/net/attempt.hpp"

#include <algorithm>
#include <utility>

#include "client/replica/evidence.hpp"
#include "client/replica/replica.hpp"
#include "client/replica/thin.hpp"
#include "protocol/build_text.hpp"

namespace cycloid::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPingInterval{500};

std::unique_ptr<Follower> make_follower(const JoinOptions& options, scenes::Simulation simulation,
                                        bool holds_state) {
  FollowerOptions follower;
  follower.scene_digest = scenes::scene_digest(options.scene);
  follower.seat_wish = options.seat_wish;
  follower.name = options.name;
  follower.room = options.room;
  follower.resume = options.resume;
  follower.holds_state = holds_state;
  // A token is good once; the resume token stands for it from then on.
  if (options.resume.empty()) follower.token = options.token;
  follower.profile = options.profile;
  follower.predict_ticks = options.predict_ticks;
  follower.one_shot = one_shot_buttons(options.scene);
  follower.witness = options.witness;
  if (!follower.witness) follower.witness = std::make_shared<Evidence>();
  follower.build = protocol::build_text();
  follower.on_frame = options.on_frame;
  follower.on_notice = options.on_notice;
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

}  // namespace

Visit::Attempt::Attempt(const JoinOptions& options, scenes::Simulation simulation, bool holds_state,
                        std::chrono::milliseconds wait)
    : options_(options),
      follower_(make_follower(options, std::move(simulation), holds_state)),
      timer_(io_),
      connection_(io_, {options.connect, options.silence}, handlers(), options.tls) {
  if (wait.count() == 0) {
    connection_.open(options_.host, options_.port);
    return;
  }
  timer_.expires_after(wait);
  timer_.async_wait([this](const asio::error_code& error) {
    if (!error && !left_) connection_.open(options_.host, options_.port);
  });
}

Connection::Handlers Visit::Attempt::handlers() {
  return {[this] { greet(); }, [this](const protocol::ServerMessage& message) { receive(message); },
          [this] { on_poll(); },
          [this](const std::string& reason) {
            if (!left_) leave(End::kDisconnected, reason);
          }};
}

void Visit::Attempt::poll(std::chrono::milliseconds wait) {
  if (io_.run_one_for(wait) != 0) io_.poll();
  if (left_) return;
  react();
}

void Visit::Attempt::greet() {
  opened_ = pinged_ = Clock::now();
  open_ = true;
  follower_->greet(outbox_);
  flush();
}

void Visit::Attempt::receive(const protocol::ServerMessage& message) {
  if (left_) return;
  const Phase before = follower_->progress().phase;
  follower_->receive(message, outbox_);
  heard_ = true;
  flush();
  const Progress& progress = follower_->progress();
  if (before == Phase::kGreeting && follower_->welcomed() && options_.on_welcome) {
    options_.on_welcome(follower_->welcome());
  }
  if (progress.over()) react();
  if (progress.phase == Phase::kEnded) return leave(End::kBye, progress.reason);
  if (progress.phase == Phase::kRefused) return leave(End::kRefused, progress.reason);
  if (progress.phase == Phase::kFailed) return leave(End::kFailed, progress.reason);
  const std::uint64_t first = first_tick_.value_or(progress.first_tick);
  const std::uint64_t seen = std::max(progress.last_tick, first) - first;
  if (options_.ticks != 0 && progress.begun() && seen >= options_.ticks) {
    react();
    leave(End::kTicks, "all ticks seen");
  }
}

/// Brings predictions up to all that was taken in and to the clock, then shows it. Until the
/// server's first state is whole there is only the world as it was built, or as another connection
/// left it.
void Visit::Attempt::react() {
  if (heard_) follower_->settle();
  const bool advanced = advance();
  const bool shows = (heard_ || advanced) && follower_->progress().begun();
  if (shows && options_.on_progress) options_.on_progress(*follower_);
  heard_ = false;
}

/// Where frames do not come, the clock goes on for the player: predicts as many ticks as have
/// passed, until the window is full. Whether it did.
bool Visit::Attempt::advance() {
  const auto now = Clock::now();
  const Progress& progress = follower_->progress();
  if (options_.predict_ticks == 0 || progress.phase != Phase::kRunning) return false;
  if (progress.last_tick != frame_tick_) {
    frame_tick_ = progress.last_tick;
    frame_at_ = now;
    advanced_ = 0;
  }
  const auto waited = std::chrono::duration_cast<std::chrono::microseconds>(now - frame_at_);
  const auto passed = static_cast<std::uint64_t>(waited.count()) *
                      follower_->tick_rate_millihertz() / 1'000'000'000;
  const std::uint64_t before = advanced_;
  while (advanced_ < passed && follower_->advance(outbox_)) ++advanced_;
  flush();
  return advanced_ != before;
}

void Visit::Attempt::on_poll() {
  if (left_) return;
  if (options_.should_stop && options_.should_stop()) return leave(End::kStopped, "told to stop");
  if (!open_) return;
  const auto now = Clock::now();
  if (!follower_->progress().begun() && now - opened_ > options_.handshake) {
    return leave(End::kDisconnected,
                 follower_->welcomed() ? "no state in time" : "no welcome in time");
  }
  if (now - pinged_ < kPingInterval) return;
  pinged_ = now;
  follower_->ping(outbox_);
  flush();
}

void Visit::Attempt::flush() {
  for (const protocol::ClientMessage& message : outbox_) connection_.send(message);
  outbox_.clear();
}

/// The first end is the one that counts.
void Visit::Attempt::leave(End end, const std::string& reason) {
  if (left_) return;
  left_ = true;
  end_ = end;
  reason_ = reason;
  timer_.cancel();
  const bool our_choice = end == End::kTicks || end == End::kStopped || end == End::kFailed;
  if (our_choice && open_) connection_.send(protocol::Bye{reason});
  connection_.finish(reason);
}

}  // namespace cycloid::client
