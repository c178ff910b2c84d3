#include "cli/sim/client.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "client/replica/replica.hpp"
#include "client/replica/thin.hpp"
#include "scenes/catalogue.hpp"
#include "solver/version.hpp"

namespace cycloid::sim {
namespace {

constexpr std::int64_t kFarewellNs = kSecond;
constexpr std::size_t kUnsentBytesMax = std::size_t{1} << 20;
/// No quantised snapshot of the scenes of a run is as large.
constexpr std::size_t kBindsNothing_bytes = 65536;

}  // namespace

SimClient::SimClient(const Settings& settings, const scenes::Scene& scene, Persona persona,
                     Random random, Host& host, Chronicle& chronicle)
    : settings_(&settings),
      scene_(&scene),
      persona_(std::move(persona)),
      random_(random),
      host_(&host),
      chronicle_(&chronicle),
      scene_digest_(scenes::scene_digest(scene)) {
  const std::int64_t drift = settings.client.drift_max_ppm;
  drift_ppm_ = random_.between(-drift, drift);
  dial_at_ns_ = random_.between(0, kSecond);
  const server::TokenPolicy tokens = settings.server.tokens;
  shows_token_ = tokens == server::TokenPolicy::kRequired ||
                 (tokens == server::TokenPolicy::kOptional && random_.one_in(2));
}

void SimClient::step() {
  for (const auto& ghost : ghosts_) ghost->step(*chronicle_);
  if (wire_) wire_->step(*chronicle_);
  if (!wire_ && !ended_ && chronicle_->now_ns >= dial_at_ns_) dial();
  if (wire_) make_mischief();
  if (wire_) read();
  if (wire_) look_at_the_clock();
  if (wire_) send();
}

void SimClient::dial() {
  dial_at_ns_ = chronicle_->now_ns + random_.between(100, 1'000) * kMillisecond;
  if (!host_->listens(persona_.room)) return;
  wire_ = make_wire(settings_->network, random_, *chronicle_);
  wire_->room = persona_.room;
  wire_->address = persona_.address;
  wire_->number = chronicle_->counted(Event::kConnection);
  host_->accept(wire_);
  RoomHost& room = host_->room(persona_.room);
  if (wire_->flips_up) room.ledger(wire_->era).excuse_inputs();
  if (wire_->flips_up || wire_->flips_down) room.excuse_desyncs();
  dialed_ns_ = chronicle_->now_ns;
  keep_state();
  observer_.emplace(room.ledger(wire_->era), persona_.name, *chronicle_);
  framer_.emplace(protocol::kServerMessageBytesMax);
  chronicle_->note(persona_.name + " connects: connection " + std::to_string(wire_->number));
  unsent_.clear();
  outbox_.clear();
  farewell_until_ns_ = kNever;
  heard_local_ns_ = pinged_local_ns_ = local_ns();
  mismatches_ = contradicted_tick_ = 0;
  draw_mischief();
  make_follower();
  follower_->greet(outbox_);
}

/// As client::Visit does; but what came over a damaged connection is nobody's word, later either.
void SimClient::keep_state() {
  if (!follower_) return;
  const bool trusted = !observer_->excused() && !ticket_.secret.empty();
  if (trusted && follower_->keep(kept_.state)) {
    kept_.is_there = true;
    kept_.disturbed = observer_->disturbed();
  } else if (!trusted || follower_->progress().begun()) {
    kept_.is_there = false;
  }
}

void SimClient::make_follower() {
  client::FollowerOptions options;
  options.scene_digest = scene_digest_;
  options.seat_wish = persona_.seat_wish;
  options.name = persona_.name;
  options.profile = persona_.profile;
  if (shows_token_) {
    RoomHost& room = host_->room(persona_.room);
    server::AdmissionToken token = room.issuer().token(room.name(), chronicle_->now_ns);
    token.identity = persona_.name;
    token_ = room.issuer().sign(token);
    options.token = token_;
  }
  resumes_ = !ticket_.secret.empty();
  options.resume = ticket_.secret;
  options.input = [this](int seat, std::uint64_t tick) {
    return honest_input(settings_->seed, seat, tick);
  };
  options.holds_state = kept_.is_there;
  auto simulation = std::move(scenes::Simulation::create(*scene_).value());
  if (kept_.is_there) simulation.restore(kept_.state);
  if (lockstep()) {
    follower_ = std::make_unique<client::Replica>(std::move(simulation), std::move(options));
  } else {
    follower_ = std::make_unique<client::Thin>(std::move(simulation), std::move(options));
  }
}

void SimClient::read() {
  const std::int64_t now = chronicle_->now_ns;
  if (now >= mischief_.zero_window_ns && now < mischief_.zero_window_until_ns) return;
  if (mischief_.zero_window_ns != kNever && now >= mischief_.zero_window_until_ns) {
    chronicle_->count(Event::kZeroWindow);
    mischief_.zero_window_ns = kNever;
  }
  for (;;) {
    if (wire_->down.is_reset()) return leave("its connection is reset");
    const auto bytes = wire_->down.read(kReadBytes);
    if (bytes.empty()) break;
    heard_local_ns_ = local_ns();
    chronicle_->mix(bytes.size() ^ static_cast<std::uint64_t>(now));
    if (wire_->down.flips() != 0) observer_->excuse();
    (void)framer_->feed(bytes);
    while (const auto payload = framer_->next()) {
      const auto decoded = protocol::decode_server(*payload);
      if (!decoded.message) {
        blame("hears what is no message: " + decoded.error);
        return leave("hears what is no message");
      }
      if (farewell_until_ns_ == kNever) take(*decoded.message);
      if (!wire_) return;
    }
    if (framer_->broken()) {
      blame("hears of a message of " + std::to_string(framer_->announced_bytes()) + " bytes");
      return leave("hears of a message of a wrong size");
    }
  }
  if (wire_->down.at_end()) leave("the server hung up");
}

void SimClient::take(const protocol::ServerMessage& message) {
  if (const auto* welcome = std::get_if<protocol::Welcome>(&message)) {
    const bool looks_on = welcome->seat < 0;
    observer_->welcomed(welcome->tick, wire_->timeline,
                        looks_on ? settings_->spectator_delay_ticks : 0);
  }
  observer_->heard(message);
  const std::uint64_t snapshots = follower_->progress().snapshots;
  if (settings_->plant == Plant::kNone) {
    follower_->receive(message, outbox_);
  } else {
    take_planted(message);
  }
  if (std::holds_alternative<protocol::Welcome>(message)) go_on_from_kept();
  check_after(snapshots);
  if (const auto* welcome = std::get_if<protocol::Welcome>(&message)) take_welcome(*welcome);
  const client::Progress& progress = follower_->progress();
  if (!progress.over()) return;
  if (progress.phase == client::Phase::kFailed) blame("fails: " + progress.reason);
  if (progress.refused) {
    take_refusal(*progress.refused);
  }
  ended_ = progress.phase == client::Phase::kEnded && host_->draining();
  finish(progress.reason);
}

/// What was wrong with the state when its connection ended still is.
void SimClient::go_on_from_kept() {
  if (follower_->progress().states_kept == 0) return;
  chronicle_->count(Event::kStateKept);
  if (kept_.disturbed) observer_->disturb();
}

void SimClient::take_welcome(const protocol::Welcome& welcome) {
  if (!follower_->welcomed()) return;
  if (resumes_) {
    chronicle_->count(Event::kSeatResumed);
    if (welcome.seat != ticket_.seat) {
      blame("came back for seat " + std::to_string(ticket_.seat) + " and was given seat " +
            std::to_string(welcome.seat));
    }
  } else if (shows_token_) {
    host_->room(persona_.room).used_token() = token_;
  }
  const bool is_damaged = wire_->flips_up || wire_->flips_down;
  ticket_ = {welcome.resume, wire_->seat, wire_->era, dialed_ns_, ghosts_.empty() && !is_damaged};
}

/// Its one try comes on a new connection, in time, to the same match, and no other connection of
/// its own or damage on the way can have used the secret.
bool SimClient::is_owed_its_seat() const {
  const bool in_time =
      chronicle_->now_ns - ticket_.lost_since_ns < settings_->limits.resume.count();
  return ticket_.is_clear && in_time && ticket_.era == wire_->era && ghosts_.empty();
}

void SimClient::take_refusal(const protocol::Refused& refused) {
  using protocol::Refusal;
  const Refusal code = refused.code;
  if (code == Refusal::kTooSlow) chronicle_->count(Event::kSlowPeerDropped);
  const bool fault = code == Refusal::kBadMessage || code == Refusal::kTooLarge ||
                     code == Refusal::kProtocolVersion || code == Refusal::kSolverVersion ||
                     code == Refusal::kSceneDigest || code == Refusal::kNoSuchSeat ||
                     code == Refusal::kTokenInvalid || code == Refusal::kTokenExpired ||
                     code == Refusal::kTokenUsed || code == Refusal::kTokenScope ||
                     code == Refusal::kNoSuchRoom || code == Refusal::kRateLimited ||
                     (code == Refusal::kResumeUnknown && is_owed_its_seat());
  if (fault && wire_->up.flips() == 0) blame("is refused: " + refused.reason);
  // A connection that is lost keeps its seat; whoever is sent away for another reason does not.
  const bool keeps = code == Refusal::kTooSlow || code == Refusal::kReplaced;
  if (code == Refusal::kResumeUnknown) ticket_ = {};
  ticket_.is_clear = ticket_.is_clear && keeps;
}

void SimClient::check_after(std::uint64_t snapshots_before) {
  const client::Progress& progress = follower_->progress();
  if (progress.snapshots != snapshots_before && observer_->disturbed()) {
    observer_->mended();
    chronicle_->count(Event::kResync);
  }
  if (progress.mismatches != mismatches_ && !observer_->disturbed()) {
    blame("is told another digest than its own");
  }
  if (progress.snapshots != snapshots_before) contradicted_tick_ = 0;
  if (progress.mismatches != mismatches_) contradicted_tick_ = host_->room(persona_.room).tick();
  mismatches_ = progress.mismatches;
  if (persona_.profile == protocol::Profile::kExact) {
    observer_->check_state(*follower_);
  } else {
    observer_->check_shown(*follower_, settings_->limits.snapshot_bytes_max < kBindsNothing_bytes);
  }
}

void SimClient::send() {
  for (const protocol::ClientMessage& message : outbox_) {
    const protocol::Bytes bytes = protocol::encode(message);
    unsent_.insert(unsent_.end(), bytes.begin(), bytes.end());
  }
  outbox_.clear();
  const std::size_t sent = wire_->up.write(unsent_);
  unsent_.erase(unsent_.begin(), unsent_.begin() + static_cast<std::ptrdiff_t>(sent));
  if (unsent_.size() > kUnsentBytesMax) {
    chronicle_->violate(Invariant::kQueues, persona_.name + " has more than 1 MiB to say");
  }
  if (farewell_until_ns_ != kNever && unsent_.empty()) wire_->up.finish();
}

void SimClient::look_at_the_clock() {
  if (chronicle_->now_ns >= farewell_until_ns_) return leave("its farewell took too long");
  if (farewell_until_ns_ != kNever) return;
  if (local_ns() - heard_local_ns_ > settings_->client.silence_ns) {
    return leave("the server fell silent");
  }
  if (local_ns() - pinged_local_ns_ < settings_->client.ping_ns) return;
  pinged_local_ns_ = local_ns();
  follower_->ping(outbox_);
}

/// Says no more, and waits for the server to hang up.
void SimClient::finish(const std::string& why) {
  if (farewell_until_ns_ != kNever) return;
  chronicle_->note(persona_.name + " ends: " + why);
  farewell_until_ns_ = chronicle_->now_ns + kFarewellNs;
}

void SimClient::leave(const std::string& why) {
  chronicle_->note(persona_.name + " is without connection: " + why);
  wire_->reset();
  wire_ = nullptr;
  dial_at_ns_ = chronicle_->now_ns + random_.between(50, 1'500) * kMillisecond;
}

void SimClient::blame(const std::string& what) {
  const bool damaged = observer_->excused() || wire_->up.flips() != 0;
  if (!damaged) chronicle_->violate(Invariant::kHonesty, persona_.name + " " + what);
}

void SimClient::storm() {
  if (wire_) leave("a storm");
  dial_at_ns_ = 0;
}

void SimClient::calm() {
  for (const auto& ghost : ghosts_) ghost->reset();
  ghosts_.clear();
  mischief_ = {};
  if (!wire_) return;
  wire_->calm();
  // What it has said of that comes at once now, if it was on the way.
  if (contradicted_tick_ != 0) contradicted_tick_ = host_->room(persona_.room).tick();
  if (wire_->flips_up || wire_->flips_down) leave("nothing is owed to a damaged connection");
}

std::string SimClient::lacks() const {
  const RoomHost& room = host_->room(persona_.room);
  if (!host_->listens(persona_.room)) return "has no server";
  if (room.doomed()) return "is in a room whose log has ended";
  const bool connected = wire_ && !wire_->down.is_reset() && wire_->era == room.era() &&
                         !wire_->up.finished() && !wire_->up.is_lost() && !wire_->down.is_lost() &&
                         room.serves(*wire_);
  if (!connected || farewell_until_ns_ != kNever) return "has no connection";
  const client::Progress& progress = follower_->progress();
  if (progress.phase != client::Phase::kRunning) return "has no state yet";
  if (observer_->disturbed()) return "is desynced";
  if (observer_->verified_tick() != progress.last_tick)
    return "holds a state that was not found right";
  if (room.owes_state(*wire_)) return "waits for a state, for frames were dropped";
  return lags(room.tick());
}

/// "" where it has seen what it can have seen of a match in which so many ticks are made.
std::string SimClient::lags(std::uint64_t made) const {
  constexpr std::uint64_t kOnTheWay = 4;
  const std::uint64_t last = follower_->progress().last_tick;
  const std::uint64_t late = observer_->delay_ticks();
  // The server has heard that its state was wrong, and says no more until it can send another; but
  // not where that tick was taken back meanwhile.
  if (contradicted_tick_ != 0 && last + late <= contradicted_tick_ + kOnTheWay) {
    return "waits for a state, for it was desynced";
  }
  // Who sees the match late is shown kept states, where it is shown states, when one is due.
  const std::uint64_t between =
      settings_->limits.snapshot_ticks + (late > 0 ? settings_->limits.keyframe_ticks : 0);
  const std::uint64_t most = kOnTheWay + late + (lockstep() ? 0 : between);
  if (last + most >= made) return "";
  return "is at tick " + std::to_string(last) + " of " + std::to_string(made);
}

}  // namespace cycloid::sim
