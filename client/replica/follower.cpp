#include "client/replica/follower.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "protocol/overloaded.hpp"

namespace cycloid::client {
namespace {

/// A server that asks for more lead than this is not one of ours; it bounds a burst of inputs.
constexpr std::uint32_t kInputDelayTicksMax = 256;

}  // namespace

Follower::Follower(protocol::Mode mode, scenes::Simulation simulation, FollowerOptions options)
    : simulation_(std::move(simulation)),
      mode_(mode),
      options_(std::move(options)),
      assembly_(std::min(options_.snapshot_bytes_max, protocol::kServerMessageBytesMax)) {}

void Follower::greet(Outbox& out) {
  protocol::Hello hello;
  hello.scene_digest = options_.scene_digest;
  hello.mode = mode_;
  hello.seat_wish = options_.seat_wish;
  hello.name = options_.name;
  hello.room = options_.room;
  hello.token = options_.token;
  hello.resume = options_.resume;
  hello.build = options_.build;
  hello.profile = options_.profile;
  out.emplace_back(std::move(hello));
  if (holds_state()) out.emplace_back(protocol::Ack{simulation_.tick()});
}

bool Follower::holds_state() const {
  return options_.holds_state && mode_ == protocol::Mode::kLockstep && !options_.resume.empty();
}

bool Follower::expect_state(const char* what) {
  if (progress_.phase != Phase::kGreeting) return true;
  fail(std::string(what) + " before the welcome");
  return false;
}

void Follower::receive(const protocol::ServerMessage& message, Outbox& out) {
  if (progress_.over()) return;
  const auto handler = protocol::Overloaded{
      [&](const protocol::Welcome& welcome) { on_welcome(welcome, out); },
      [&](const protocol::Refused& refused) { on_refused(refused); },
      [&](const protocol::InputFrame& frame) {
        if (expect_state("a frame") && check_frame(frame)) on_frame(frame, out);
      },
      [&](const protocol::Snapshot& snapshot) {
        if (!expect_state("a snapshot")) return;
        assembly_.clear();
        on_exact(snapshot, out);
      },
      [&](const protocol::SnapshotPart& part) {
        if (expect_state("a part of a snapshot")) on_part(part, out);
      },
      [&](const protocol::StateDelta& delta) {
        if (expect_state("a delta")) on_delta(delta, out);
      },
      [&](const protocol::Digest& digest) {
        if (expect_state("a digest")) on_digest(digest, out);
      },
      [&](const protocol::Margin& margin) {
        if (expect_state("a margin")) on_margin(margin);
      },
      [&](const protocol::StateWanted& wanted) {
        if (expect_state("a wish for the state") && options_.witness)
          options_.witness->wanted(wanted, out);
      },
      [&](const protocol::RoomNotice& notice) {
        if (expect_state("a notice")) on_notice(notice);
      },
      [&](const protocol::Pong& pong) { on_pong(pong); },
      [&](const protocol::Bye& bye) {
        progress_.phase = Phase::kEnded;
        progress_.reason = bye.reason;
      },
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

void Follower::on_refused(const protocol::Refused& refused) {
  progress_.refused = refused;
  progress_.phase = Phase::kRefused;
  progress_.reason = refused.reason;
}

void Follower::on_welcome(const protocol::Welcome& welcome, Outbox& out) {
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
  welcomed_ = true;
  base_tick_ = welcome.tick;
  lead_.start(welcome.tick, welcome.input_delay_ticks);
  progress_.lead_ticks = lead_.lead_ticks();
  progress_.seat = welcome.seat;
  progress_.phase = Phase::kLoading;
  on_seated();
  if (holds_state() && welcome.tick == simulation_.tick()) go_on_from_kept(out);
}

/// The frames since come at once, and what I would say for their ticks is late: so nothing is said
/// until the tick is made at which the match is now. A server that sends a state all the same is
/// heard, too.
void Follower::go_on_from_kept(Outbox& out) {
  progress_.first_tick = progress_.last_tick = welcome_.tick;
  progress_.phase = Phase::kRunning;
  ++progress_.states_kept;
  on_kept();
  ping(out);
  catch_up_ping_ = pings_;
}

void Follower::on_pong(const protocol::Pong& pong) {
  if (pong.token == 0 || pong.token > pings_) return fail("a pong that was not asked for");
  if (pong.token != catch_up_ping_) return;
  catch_up_ping_ = 0;
  caught_up_tick_ = pong.tick;
}

void Follower::on_part(const protocol::SnapshotPart& part, Outbox& out) {
  if (const std::string wrong = assembly_.take(part); !wrong.empty()) {
    return fail("a part of the snapshot of tick " + std::to_string(part.tick) + " " + wrong);
  }
  if (const auto whole = assembly_.finish()) on_exact(*whole, out);
}

void Follower::on_margin(const protocol::Margin& margin) {
  progress_.early_ticks = margin.early_ticks;
  if (!seated()) return;
  lead_.take(margin, sent_tick());
  progress_.lead_ticks = lead_.lead_ticks();
}

void Follower::on_notice(const protocol::RoomNotice& notice) {
  if (notice.kind == protocol::NoticeKind::kRewound) {
    assembly_.clear();
    base_tick_ = notice.value;
    lead_.start(notice.value, welcome_.input_delay_ticks);
    progress_.lead_ticks = lead_.lead_ticks();
    progress_.last_tick = notice.value;
    progress_.first_tick = std::min(progress_.first_tick, notice.value);
    progress_.phase = Phase::kLoading;
    ++progress_.rewinds;
    first_input_tick_ = next_input_tick_ = 0;
    catch_up_ping_ = caught_up_tick_ = 0;
    on_rewound(notice.value);
  }
  if (options_.on_notice) options_.on_notice(notice);
}

std::optional<std::uint64_t> Follower::assembling_tick() const {
  if (!assembly_.under_way()) return std::nullopt;
  return assembly_.tick();
}

bool Follower::load(std::uint64_t tick, std::uint64_t digest, std::span<const std::byte> state) {
  const std::string name = "the snapshot of tick " + std::to_string(tick);
  if (loading() && tick < base_tick_) {
    fail(name + " is older than the one that was announced, of " + std::to_string(base_tick_));
    return false;
  }
  if (const solver::Error error = simulation_.decode(state); !error.ok()) {
    fail(name + " is corrupt: " + error.field);
    return false;
  }
  if (simulation_.tick() != tick || simulation_.digest() != digest) {
    fail(name + " is not of the tick or the digest that it says");
    return false;
  }
  loaded(tick);
  return true;
}

void Follower::loaded(std::uint64_t tick) {
  if (!progress_.begun()) progress_.first_tick = tick;
  progress_.last_tick = tick;
  progress_.phase = Phase::kRunning;
  catch_up_ping_ = caught_up_tick_ = 0;
  ++progress_.snapshots;
}

void Follower::send_inputs(std::uint64_t last, std::uint64_t burst, Outbox& out) {
  if (!seated() || !options_.input || catches_up()) return;
  if (first_input_tick_ == 0) next_input_tick_ = progress_.last_tick + lead();
  // After a leap of the lead the ticks before are past saving.
  if (last >= burst) next_input_tick_ = std::max(next_input_tick_, last - burst + 1);
  for (; next_input_tick_ <= last; ++next_input_tick_) {
    if (first_input_tick_ == 0) first_input_tick_ = next_input_tick_;
    const scenes::SeatInput input = options_.input(progress_.seat, next_input_tick_);
    out.emplace_back(protocol::Input{next_input_tick_, input});
    on_said(next_input_tick_, input);
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
  for (const protocol::FrameChange& change : frame.changes) {
    if (change.value != 0 && change.value <= kInputDelayTicksMax) continue;
    fail(name + " changes the input delay to " + std::to_string(change.value) + " ticks");
    return false;
  }
  return true;
}

void Follower::take_frame(const protocol::InputFrame& frame) {
  ++progress_.frames;
  for (const protocol::FrameChange& change : frame.changes) {
    welcome_.input_delay_ticks = change.value;
    lead_.change_delay(change.value, sent_tick());
    progress_.lead_ticks = lead_.lead_ticks();
  }
  if (options_.on_frame) options_.on_frame(frame);
  if (!seated() || first_input_tick_ == 0 || frame.tick < first_input_tick_) return;
  const auto seat = static_cast<std::size_t>(progress_.seat);
  if (frame.seats[seat].origin != protocol::Origin::kGiven) ++progress_.inputs_replaced;
}

}  // namespace cycloid::client
