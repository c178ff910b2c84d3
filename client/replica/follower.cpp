#include "client/replica/follower.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace cycloid::client {
namespace {

/// A server that asks for more lead than this is not one of ours; it bounds a burst of inputs.
constexpr std::uint32_t kInputDelayTicksMax = 256;

template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
// Implied by C++20, but Clang before 17 does not know.
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

}  // namespace

Follower::Follower(protocol::Mode mode, scenes::Simulation simulation, FollowerOptions options)
    : simulation_(std::move(simulation)), mode_(mode), options_(std::move(options)) {}

void Follower::greet(Outbox& out) {
  protocol::Hello hello;
  hello.scene_digest = options_.scene_digest;
  hello.mode = mode_;
  hello.seat_wish = options_.seat_wish;
  hello.name = options_.name;
  out.emplace_back(std::move(hello));
}

void Follower::receive(const protocol::ServerMessage& message, Outbox& out) {
  if (progress_.over()) return;
  const auto handler = Overloaded{
      [&](const protocol::Welcome& welcome) { on_welcome(welcome); },
      [&](const protocol::Refused& refused) {
        progress_.refused = refused;
        progress_.phase = Phase::kRefused;
        progress_.reason = refused.reason;
      },
      [&](const protocol::InputFrame& frame) {
        if (progress_.phase != Phase::kRunning) return fail("a frame before the first snapshot");
        on_frame(frame, out);
      },
      [&](const protocol::Snapshot& snapshot) {
        if (progress_.phase == Phase::kGreeting) return fail("a snapshot before the welcome");
        on_snapshot(snapshot, out);
      },
      [&](const protocol::Digest& digest) {
        if (progress_.phase != Phase::kRunning) return fail("a digest before the first snapshot");
        on_digest(digest, out);
      },
      [&](const protocol::Pong& pong) { on_pong(pong); },
      [&](const protocol::Bye& bye) {
        progress_.phase = Phase::kEnded;
        progress_.reason = bye.reason;
      },
      [](const auto&) {},
  };
  std::visit(handler, message);
}

void Follower::ping(Outbox& out) {
  if (progress_.phase == Phase::kGreeting || progress_.over()) return;
  ++pings_;
  out.emplace_back(protocol::Ping{pings_});
}

void Follower::fail(std::string reason) {
  progress_.phase = Phase::kFailed;
  progress_.reason = std::move(reason);
}

void Follower::on_welcome(const protocol::Welcome& welcome) {
  const auto seats = static_cast<std::uint32_t>(simulation_.seats());
  if (progress_.phase != Phase::kGreeting) return fail("a second welcome");
  if (welcome.seats != seats) {
    return fail("the server has " + std::to_string(welcome.seats) + " seats, the scene here has " +
                std::to_string(seats));
  }
  const bool spectates = welcome.seat == protocol::kSpectator;
  if (!spectates && (welcome.seat < 0 || welcome.seat >= simulation_.seats())) {
    return fail("the server gave out seat " + std::to_string(welcome.seat) + " of " +
                std::to_string(seats));
  }
  if (welcome.input_delay_ticks == 0 || welcome.input_delay_ticks > kInputDelayTicksMax) {
    return fail("an input delay of " + std::to_string(welcome.input_delay_ticks) + " ticks");
  }
  welcome_ = welcome;
  progress_.seat = welcome.seat;
  progress_.phase = Phase::kLoading;
}

void Follower::on_pong(const protocol::Pong& pong) {
  if (pong.token == 0 || pong.token > pings_) fail("a pong that was not asked for");
}

bool Follower::load(const protocol::Snapshot& snapshot) {
  const bool first = progress_.phase == Phase::kLoading;
  const std::string name = "the snapshot of tick " + std::to_string(snapshot.tick);
  if (first && snapshot.tick != welcome_.tick) {
    fail(name + " is not the one that the welcome announced, of " + std::to_string(welcome_.tick));
    return false;
  }
  if (!first && snapshot.tick < simulation_.tick()) {
    fail(name + " is older than the state, of tick " + std::to_string(simulation_.tick()));
    return false;
  }
  if (const solver::Error error = simulation_.decode(snapshot.state); !error.ok()) {
    fail(name + " is corrupt: " + error.field);
    return false;
  }
  if (simulation_.tick() != snapshot.tick || simulation_.digest() != snapshot.digest) {
    fail(name + " is not of the tick or the digest that it says");
    return false;
  }
  if (first) progress_.first_tick = snapshot.tick;
  progress_.last_tick = snapshot.tick;
  progress_.phase = Phase::kRunning;
  ++progress_.snapshots;
  return true;
}

void Follower::send_inputs(std::uint64_t last, Outbox& out) {
  if (!seated() || !options_.input) return;
  next_input_tick_ = std::max(next_input_tick_, simulation_.tick() + input_delay());
  for (; next_input_tick_ <= last; ++next_input_tick_) {
    if (first_input_tick_ == 0) first_input_tick_ = next_input_tick_;
    const scenes::SeatInput input = options_.input(progress_.seat, next_input_tick_);
    out.emplace_back(protocol::Input{next_input_tick_, input});
    ++progress_.inputs_sent;
  }
}

bool Follower::check_frame(const protocol::InputFrame& frame) {
  const auto seats = static_cast<std::size_t>(simulation_.seats());
  const std::string name = "the frame of tick " + std::to_string(frame.tick);
  if (frame.seats.size() != seats) {
    fail(name + " has " + std::to_string(frame.seats.size()) + " seats instead of " +
         std::to_string(seats));
    return false;
  }
  for (const protocol::FrameEvent& event : frame.events) {
    if (event.seat < seats) continue;
    fail(name + " has an event of seat " + std::to_string(event.seat));
    return false;
  }
  return true;
}

void Follower::count_frame(const protocol::InputFrame& frame) {
  ++progress_.frames;
  if (!seated() || first_input_tick_ == 0 || frame.tick < first_input_tick_) return;
  const auto seat = static_cast<std::size_t>(progress_.seat);
  if (frame.seats[seat].origin != protocol::Origin::kGiven) ++progress_.inputs_replaced;
}

}  // namespace cycloid::client
