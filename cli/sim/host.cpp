#include "cli/sim/host.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

namespace cycloid::sim {
namespace {

/// Between two reads of a log that is still written.
constexpr std::uint64_t kCheckTicks = 150;
constexpr std::int64_t kRewindTicksMax = 200;
/// Hellos that one address may owe at a time: all strangers call from one.
constexpr std::uint32_t kStrangersPendingMax = 4;
/// From the end of a room to the next start of the server.
constexpr std::int64_t kStopNs = 3 * kSecond / 2;

scenes::Simulation simulation_of(const scenes::Scene& scene) {
  return std::move(scenes::Simulation::create(scene).value());
}

}  // namespace

RoomHost::RoomHost(const Settings& settings, const scenes::Scene& scene, std::size_t number,
                   const Random& random, SimDisk& disk, Chronicle& chronicle)
    : settings_(&settings),
      scene_(&scene),
      number_(number),
      disk_(&disk),
      chronicle_(&chronicle),
      scene_digest_(scenes::scene_digest(scene)),
      scene_bytes_(scenes::to_binary(scene)),
      secrets_(random.fork(1)),
      issuer_(random.fork(2)) {}

server::RoomOptions RoomHost::room_options() const {
  server::RoomOptions options;
  options.limits = settings_->limits;
  if (settings_->plant == Plant::kRoomOutboxUnbounded) {
    options.limits.queue_bytes_max = std::size_t{1} << 30;
  }
  options.scene_digest = scene_digest_;
  options.name = name();
  const bool forgets = settings_->plant == Plant::kRoomForgetsDelay;
  options.spectator_delay_ticks = forgets ? 0 : settings_->spectator_delay_ticks;
  options.tick_rate_millihertz = settings_->tick_rate_millihertz;
  options.stop_on_log_error = settings_->server.stop_on_log_error;
  return options;
}

server::GateOptions RoomHost::gate_options() const {
  server::GateOptions options;
  const bool trusts = settings_->plant == Plant::kGateTrustsTokens;
  options.tokens = trusts ? server::TokenPolicy::kIgnored : settings_->server.tokens;
  options.keys = {issuer_.public_key()};
  options.hello_deadline_ns = settings_->limits.handshake.count();
  options.addresses.host_pending_max = kStrangersPendingMax;
  return options;
}

void RoomHost::open() {
  for (Session& session : sessions_) session.die();
  sessions_.clear();
  over_at_ns_ = kNever;
  std::optional<scenes::Simulation> shown;
  if (settings_->quantised_of_million != 0) shown = simulation_of(*scene_);
  ledgers_.push_back(std::make_unique<Ledger>(settings_->seed, *chronicle_, std::move(shown)));
  used_token_.clear();
  desyncs_excused_ = false;
  protocol::LogHeader header;
  header.scene_digest = scene_digest_;
  header.salt = scramble(settings_->seed ^ scramble(number_ * 1000 + era()));
  header.scene_name = scene_->name;
  header.scene = scene_bytes_;
  const ServerSettings& server = settings_->server;
  const SimLog::Options options{server.log, server.sync_interval_ns, server.log_queue_bytes_max,
                                server.keyframe_ticks, settings_->plant};
  const std::uint64_t first_file = (number_ * 1000 + era()) * 1000;
  log_ = std::make_unique<SimLog>(*disk_, first_file, header, options, *chronicle_);
  confirm_ = std::make_unique<Confirm>(*ledgers_.back(), *log_);
  server::RoomHooks hooks;
  hooks.now_ns = [this] { return chronicle_->now_ns; };
  hooks.notice = [this](const server::Notice& notice) {
    chronicle_->note("room " + std::to_string(number_) + ": " + notice.text);
  };
  hooks.log = confirm_.get();
  if (settings_->server.gives_resume_secrets) {
    hooks.random = [this](std::span<std::byte> into) {
      if (settings_->plant != Plant::kRoomGivesEqualSecrets) secrets_.fill(into);
    };
  }
  room_ = std::make_unique<server::Room>(room_options(), simulation_of(*scene_), std::move(hooks));
  const auto find_room = [this](const std::string& room, const server::Admission&) {
    const bool here = room.empty() || room == name();
    return server::RoomVerdict{here ? server::RoomFound::kExists : server::RoomFound::kNoSuchRoom,
                               {}};
  };
  gate_ = std::make_unique<server::Gate>(gate_options(), find_room);
  next_check_tick_ = kCheckTicks;
}

void RoomHost::accept(std::shared_ptr<Wire> wire) {
  wire->era = era();
  sessions_.emplace_back(std::move(wire), House{gate_.get(), room_.get(), ledgers_.back().get()},
                         settings_->limits, settings_->plant, *chronicle_);
}

bool RoomHost::serves(const Wire& wire) const {
  return std::any_of(sessions_.begin(), sessions_.end(), [&](const Session& session) {
    return session.is_over(wire) && session.is_served();
  });
}

bool RoomHost::owes_state(const Wire& wire) const {
  return std::any_of(sessions_.begin(), sessions_.end(), [&](const Session& session) {
    return session.is_over(wire) && session.waits_for_state();
  });
}

void RoomHost::turn_away_overdue() {
  for (const server::GateOverdue& overdue : gate_->overdue(chronicle_->now_ns)) {
    for (Session& session : sessions_) {
      if (session.gate_id() == overdue.id) session.turn_away(overdue.refused);
    }
  }
}

void RoomHost::step(std::int64_t step_ns) {
  if (!room_) return;
  turn_away_overdue();
  for (Session& session : sessions_) session.step(step_ns);
  sessions_.remove_if([](const Session& session) { return session.closed(); });
  if (running() && chronicle_->now_ns >= room_->next_deadline_ns()) room_->advance();
  if (!running() && over_at_ns_ == kNever) over_at_ns_ = chronicle_->now_ns + kStopNs;
  log_->turn();
  check_seats();
  check_room();
  if (room_->tick() >= next_check_tick_ && running() && !disk_->killed()) {
    next_check_tick_ += kCheckTicks;
    check_log({});
  }
}

void RoomHost::check_seats() {
  std::set<std::int32_t> held;
  for (const Session& session : sessions_) {
    if (session.seat() < 0 || held.insert(session.seat()).second) continue;
    chronicle_->violate(Invariant::kSeats,
                        "seat " + std::to_string(session.seat()) + " is held by two connections");
  }
}

void RoomHost::check_room() {
  if (room_->tick() != ledgers_.back()->ticks()) {
    chronicle_->violate(Invariant::kLog, "the room is at tick " + std::to_string(room_->tick()) +
                                             ", its log heard of " +
                                             std::to_string(ledgers_.back()->ticks()));
  }
  if (room_->statistics().desyncs != 0 && !desyncs_excused_) {
    chronicle_->violate(Invariant::kHonesty, "the room takes an honest client for desynced");
  }
  const bool each = settings_->server.log == server::LogSync::kEveryTick;
  if (each && settings_->plant == Plant::kNone && log_->durable() && !disk_->killed() &&
      log_->synced_ticks() != room_->tick()) {
    chronicle_->violate(Invariant::kLog, "clients hear of tick " + std::to_string(room_->tick()) +
                                             " before it is on the disk");
  }
}

void RoomHost::rotate_log() {
  if (running()) log_->rotate();
}

void RoomHost::rewind(Random& random) {
  if (!running() || room_->tick() == 0) return;
  const std::int64_t back = random.between(1, kRewindTicksMax);
  const std::uint64_t tick = room_->tick();
  if (!room_->rewind(tick - std::min(tick, static_cast<std::uint64_t>(back)))) return;
  chronicle_->count(Event::kRewind);
}

void RoomHost::drain() {
  if (room_) room_->drain("the run is over");
}

void RoomHost::die(Death death) {
  if (!room_) return;
  for (Session& session : sessions_) session.die();
  sessions_.clear();
  gate_.reset();
  room_.reset();
  check_log(death);
  check_replay();
  log_->die();
  for (const std::uint64_t file : log_->files()) disk_->forget(file);
}

void RoomHost::check_log(std::optional<Death> death) {
  const std::uint64_t file = log_->files().back();
  const auto mistake = log_mistake({log_.get(), ledgers_.back().get(), death}, *disk_);
  if (mistake) chronicle_->violate(Invariant::kLog, *mistake);
  const auto flip = flip_mistake(*ledgers_.back(), disk_->flipped(file));
  if (flip) chronicle_->violate(Invariant::kLog, *flip);
  chronicle_->count(Event::kLogVerified);
  chronicle_->mix(disk_->content(file).size());
}

void RoomHost::check_replay() {
  if (const auto differs = ledgers_.back()->not_replayable(simulation_of(*scene_))) {
    chronicle_->violate(Invariant::kDigests, *differs);
  }
  const protocol::Bytes& log = disk_->content(log_->files().back());
  if (const auto mistake = seek_mistake(log, simulation_of(*scene_)))
    chronicle_->violate(Invariant::kLog, *mistake);
}

Host::Host(const Settings& settings, const scenes::Scene& scene, const Random& random,
           Chronicle& chronicle)
    : settings_(&settings),
      random_(random),
      chronicle_(&chronicle),
      disk_(settings.disk, random.fork(1), chronicle) {
  rooms_.reserve(settings.rooms);
  for (std::size_t room = 0; room < settings.rooms; ++room) {
    rooms_.emplace_back(settings, scene, room, random.fork(10 + room), disk_, chronicle);
  }
  draw_misfortunes();
}

void Host::draw_misfortunes() {
  const auto span_ns = static_cast<std::int64_t>(settings_->ticks * 1'000'000'000'000 /
                                                 settings_->tick_rate_millihertz);
  const auto draw = [&](std::uint32_t count, std::vector<std::int64_t>& times) {
    for (std::uint32_t i = 0; i < count; ++i) times.push_back(random_.between(0, span_ns));
    std::sort(times.begin(), times.end(), std::greater<>());  // Total order: integers.
  };
  draw(settings_->server.pauses, pauses_ns_);
  draw(settings_->server.deaths, deaths_ns_);
  draw(settings_->server.rotations, rotations_ns_);
  draw(settings_->server.rewinds, rewinds_ns_);
}

void Host::step(std::int64_t step_ns) {
  const std::int64_t now = chronicle_->now_ns;
  if (up_ && !deaths_ns_.empty() && now >= deaths_ns_.back()) {
    deaths_ns_.pop_back();
    die(random_.chance(settings_->server.power_cuts_of) ? Death::kPower : Death::kProcess);
  }
  if (!up_ && now < up_at_ns_) return;
  if (!up_) {
    up_ = true;
    if (up_at_ns_ != 0) chronicle_->count(Event::kRestart);
    for (RoomHost& room : rooms_) room.open();
  }
  if (paused()) return;
  if (!pauses_ns_.empty() && now >= pauses_ns_.back()) {
    pauses_ns_.pop_back();
    paused_until_ns_ = now + random_.between(1, settings_->server.pause_max_ns);
    chronicle_->count(Event::kServerPause);
    chronicle_->note("the server is not run for a while");
    return;
  }
  if (!rotations_ns_.empty() && now >= rotations_ns_.back()) {
    rotations_ns_.pop_back();
    for (RoomHost& room : rooms_) room.rotate_log();
  }
  if (!rewinds_ns_.empty() && now >= rewinds_ns_.back()) {
    rewinds_ns_.pop_back();
    for (RoomHost& room : rooms_) room.rewind(random_);
    if (disk_.killed()) return die(Death::kProcess);
  }
  for (RoomHost& room : rooms_) {
    room.step(step_ns);
    if (disk_.killed()) return die(Death::kProcess);
    if (draining_ || !room.over()) continue;
    // The log broke down and the room stopped, as was asked for: somebody makes room and starts it.
    disk_.enlarge();
    room.check_log({});
    room.check_replay();
    room.open();
    chronicle_->count(Event::kRestart);
  }
}

void Host::die(Death death) {
  chronicle_->count(death == Death::kPower ? Event::kPowerCut : Event::kProcessKill);
  chronicle_->note(death == Death::kPower ? "a power cut" : "the server is killed");
  disk_.kill();
  disk_.restart(death);
  for (RoomHost& room : rooms_) room.die(death);
  up_ = false;
  paused_until_ns_ = 0;
  up_at_ns_ = chronicle_->now_ns + random_.between(50, 2'000) * kMillisecond;
}

void Host::accept(std::shared_ptr<Wire> wire) {
  chronicle_->count(Event::kConnection);
  RoomHost& room = rooms_[wire->room];
  room.accept(std::move(wire));
}

void Host::calm() {
  disk_.calm();
  pauses_ns_.clear();
  deaths_ns_.clear();
  rotations_ns_.clear();
  rewinds_ns_.clear();
}

void Host::drain() {
  draining_ = true;
  for (RoomHost& room : rooms_) room.drain();
}

void Host::check_at_end() {
  for (RoomHost& room : rooms_) {
    room.check_log({});
    room.check_replay();
  }
}

}  // namespace cycloid::sim
