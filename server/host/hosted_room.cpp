#include "server/host/hosted_room.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "protocol/build_text.hpp"
#include "protocol/log_format.hpp"
#include "scenes/catalogue.hpp"
#include "server/admission/random.hpp"
#include "server/host/process_time.hpp"
#include "server/host/room_clock.hpp"

namespace cycloid::server {
namespace {

/// The longest that a room waits for its phase. Its time stands until then, so that nobody in it is
/// served in full; and a room whose ticks are rarer needs no even share of the raster.
constexpr std::int64_t kStartWaitNsMax = 1'000'000'000;

/// How often a room that makes no tick looks after its clients, its end, and who is left of it.
constexpr std::int64_t kIdleLookNs = 100'000'000;
constexpr std::int64_t kLastLookNs = 10'000'000;
/// Of a message, more than a snapshot has beside its state.
constexpr std::size_t kSnapshotBytesBeside = 1024;

std::uint64_t steady_ns() {
  return static_cast<std::uint64_t>(process_now_ns());
}

scenes::Simulation make_simulation(const RoomSettings& settings) {
  auto simulation = scenes::Simulation::create(settings.scene);
  solver::Error error = simulation.error();
  if (simulation.ok()) error = simulation.value().set_workers_at_most(settings.workers, &steady_ns);
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

std::uint32_t rate_of(const RoomSettings& settings, const scenes::Simulation& simulation) {
  if (settings.tick_rate_millihertz != 0) return settings.tick_rate_millihertz;
  return static_cast<std::uint32_t>(std::lround(1000.0 / static_cast<double>(simulation.tick_s())));
}

spdlog::level::level_enum level_of(Notice::Kind kind) {
  switch (kind) {
    case Notice::Kind::kJoin:
    case Notice::Kind::kLeave:
    case Notice::Kind::kEnd:
    case Notice::Kind::kAct:
      return spdlog::level::info;
    case Notice::Kind::kFault:
    case Notice::Kind::kLog:
      return spdlog::level::err;
    default:
      return spdlog::level::warn;
  }
}

}  // namespace

HostedRoom::HostedRoom(RoomSite site, std::string name, RoomSettings settings, std::uint32_t slot)
    : site_(std::move(site)),
      name_(std::move(name)),
      settings_(std::move(settings)),
      slot_(slot),
      strand_(asio::make_strand(site_.io)),
      timer_(strand_),
      simulation_(make_simulation(settings_)) {
  simulation_->use_step_memory(site_.step_memories);
  rate_millihertz_ = rate_of(settings_, *simulation_);
  seats_ = simulation_->seats();
  protocol::LogHeader header = protocol::log_header_of(settings_.scene);
  header.scene_name = settings_.scene_name;
  header.tick_rate_millihertz = rate_millihertz_;
  log_ = std::make_unique<RoomLog>(room_log_place(settings_, name_, site_.disk), std::move(header),
                                   site_.slow);
  meters_.tick_ns = tick_ns();
  meters_.durable.set(1);
}

std::int64_t HostedRoom::tick_ns() const {
  return protocol::Schedule(0, rate_millihertz_).deadline_ns(1);
}

void HostedRoom::start() {
  asio::post(strand_, [self = shared_from_this()] {
    self->open_room();
    self->arm();
  });
}

void HostedRoom::open_room() {
  const std::int64_t now_ns = process_now_ns();
  start_ns_ = std::min(staggered_start_ns(site_.epoch_ns, now_ns, rate_millihertz_, slot_),
                       now_ns + kStartWaitNsMax);
  RoomOptions options;
  options.limits = settings_.limits;
  options.scene_digest = scenes::scene_digest(settings_.scene);
  options.tick_rate_millihertz = rate_millihertz_;
  options.ticks = settings_.ticks;
  options.stop_on_log_error = settings_.stop_on_log_error;
  options.name = name_;
  options.policy = settings_.policy;
  options.slow = settings_.slow;
  options.delay = settings_.delay;
  options.spectator_delay_ticks = settings_.spectator_delay_ticks;
  options.build = protocol::build_text();
  const auto identity = std::make_shared<const RoomIdentity>(
      RoomIdentity{name_, std::make_shared<const scenes::Scene>(std::move(settings_.scene)),
                   options.scene_digest, options.build, rate_millihertz_});
  inquiry_ = std::make_unique<RoomInquiry>(DesyncDeskOptions{}, identity, inquiry_hooks());
  RoomHooks hooks;
  hooks.inquiry = inquiry_.get();
  hooks.now_ns = [this] { return std::max(start_ns_, process_now_ns()); };
  hooks.notice = [this](const Notice& said) { take_notice(said); };
  hooks.lateness = [this](std::uint64_t late_ns) { meters_.lateness.add(late_ns); };
  if (log_->kept()) hooks.log = log_.get();
  hooks.random = system_random();
  room_.emplace(options, std::move(*simulation_), std::move(hooks));
  simulation_.reset();
  empty_since_ns_ = now_ns;
}

/// Looking into a desync takes as long as making its ticks again: away from the strand.
RoomInquiryHooks HostedRoom::inquiry_hooks() {
  RoomInquiryHooks hooks;
  hooks.now_ns = process_now_ns;
  hooks.later = [this](std::function<void()> work, std::function<void()> done) {
    auto task = [self = shared_from_this(), work = std::move(work), done = std::move(done)] {
      work();
      asio::post(self->strand_, [self, done] { done(); });
    };
    asio::post(site_.slow, std::move(task));
  };
  hooks.publish = [name = name_, logger = site_.logger, reports = site_.reports,
                   meters = site_.meters](const Finding& finding) {
    DesyncReport report;
    ReportSink::Written written;
    if (reports != nullptr) written = reports->publish(finding, &report);
    if (reports == nullptr) report = investigate(finding);
    if (reports != nullptr) meters->reports_dropped.set(reports->dropped());
    const std::string line = report_line(report);
    const std::string where = !written.report.empty()  ? "; report " + written.report
                              : !written.error.empty() ? "; no report: " + written.error
                                                       : "";
    logger->warn("room {}: client {}: {}{}", name, finding.client.peer, line, where);
    if (report.server_suspect) {
      logger->error("room {}: the server itself is suspect: client {}: {}", name,
                    finding.client.peer, line);
    }
    return line;
  };
  return hooks;
}

void HostedRoom::take_notice(const Notice& notice) {
  const bool by_client = notice.kind == Notice::Kind::kJoin ||
                         notice.kind == Notice::Kind::kLeave ||
                         notice.kind == Notice::Kind::kRefusal;
  if (by_client) show_places();
  if (by_client && !lines_.take(1, process_now_ns())) {
    ++lines_left_out_;
    return;
  }
  const std::uint64_t left_out = by_client ? std::exchange(lines_left_out_, 0) : 0;
  const std::string more =
      left_out == 0 ? ""
                    : " (and " + std::to_string(left_out) + " lines like this left out before)";
  site_.logger->log(level_of(notice.kind), "room {}: {}{}", name_, notice.text, more);
}

/// So that a newcomer who cannot come in is turned away before its token is used up.
void HostedRoom::show_places() {
  if (!room_) return;
  const SeatTable& seats = room_->seats();
  bool full = seats.size() > 0;
  for (std::size_t seat = 0; seat < seats.size() && full; ++seat) {
    full = seats[seat].state == SeatState::kHeld || seats[seat].state == SeatState::kLost;
  }
  shown_seats_full_ = full;
  shown_full_ = !room_->takes_connections();
}

void HostedRoom::arm() {
  if (life_.stage() == LifeStage::kDraining) {  // Which may end long before a rare tick.
    return arm_at(std::min(room_->next_deadline_ns(), drain_at_ns_));
  }
  if (life_.ticking()) return arm_at(room_->next_deadline_ns());
  meters_.armed_ns = 0;
  timer_.expires_after(std::chrono::nanoseconds(kIdleLookNs));
  timer_.async_wait([self = shared_from_this()](const asio::error_code&) { self->on_tick(); });
}

void HostedRoom::arm_at(std::int64_t process_ns) {
  meters_.armed_ns = std::max(process_ns, process_now_ns());
  timer_.expires_at(process_time_point(process_ns));
  timer_.async_wait([self = shared_from_this()](const asio::error_code&) { self->on_tick(); });
}

void HostedRoom::on_tick() {
  if (!room_ || life_.stage() == LifeStage::kEnded) return;
  const std::int64_t begin_ns = process_now_ns();
  const std::uint64_t before = room_->tick();
  room_->advance();              // In a pause too: whoever is there is heard and served.
  if (room_->tick() > before) {  // Else it waits for an input, stands still, or was rewound.
    const std::uint64_t made = room_->tick() - before;
    const auto took_ns = static_cast<std::uint64_t>(process_now_ns() - begin_ns);
    meters_.tick_time.add(took_ns / made, made);
  }
  wake_sessions();
  settle(begin_ns);
}

void HostedRoom::settle(std::int64_t now_ns) {
  const bool empty = room_->peers() == 0;
  if (!empty) empty_since_ns_ = now_ns;
  const std::int64_t ttl_ns = std::chrono::nanoseconds(settings_.empty_ttl).count();
  if (room_->state() != RoomState::kRunning) {
    end(room_->end_reason());
  } else if (life_.stage() == LifeStage::kDraining && (empty || now_ns >= drain_at_ns_)) {
    end(drain_reason_);
  } else if (ttl_ns > 0 && now_ns - empty_since_ns_ >= ttl_ns) {
    end("empty for " + std::to_string(ttl_ns / 1'000'000) + " ms");
  }
  publish();
  if (life_.stage() == LifeStage::kEnded) return wait_for_last();
  arm();
}

void HostedRoom::end(const std::string& reason) {
  if (room_->state() == RoomState::kRunning) room_->drain(reason);
  (void)life_.apply(LifeAct::kEnd);  // One that has ended stays so.
  publish_stage();
  wake_sessions();
}

void HostedRoom::wait_for_last() {
  meters_.armed_ns = 0;
  if (!room_) return;
  std::erase_if(sessions_, [](const auto& session) { return session.expired(); });
  if (hurries_) {
    for (const auto& weak : sessions_) {
      if (const auto session = weak.lock()) session->close();
    }
  }
  if (!sessions_.empty() || !log_->settled()) {
    timer_.expires_after(std::chrono::nanoseconds(kLastLookNs));
    timer_.async_wait(
        [self = shared_from_this()](const asio::error_code&) { self->wait_for_last(); });
    return;
  }
  publish();
  const ServeReport last = report();
  room_.reset();
  // A writer that has closed its log has no more to do; one whose disk hangs is waited for there.
  asio::post(site_.slow, [log = std::shared_ptr<RoomLog>(std::move(log_))] {});
  site_.gone(name_, last);
}

void HostedRoom::wake_sessions() {
  std::erase_if(sessions_, [](const auto& session) { return session.expired(); });
  for (const auto& weak : sessions_) {
    if (const auto session = weak.lock()) session->wake();
  }
}

void HostedRoom::enter(Entrant entrant) {
  auto shared = std::make_shared<Entrant>(std::move(entrant));
  asio::post(strand_, [self = shared_from_this(), shared] { self->admit(std::move(*shared)); });
}

void HostedRoom::admit(Entrant entrant) {
  if (const auto refused = closed(entrant.admission); refused || !room_) {
    const protocol::Refused over{protocol::Refusal::kDraining, "the room has ended"};
    return site_.turn_away(std::move(entrant), refused ? *refused : over);
  }
  SessionPlace place{strand_, *room_, shared_from_this()};
  const auto session = std::make_shared<Session>(std::move(entrant), std::move(place));
  sessions_.push_back(session);
  session->start();
  show_places();
}

std::optional<protocol::Refused> HostedRoom::closed(const Admission& admission) const {
  // A lock shuts out neither an admin nor who only comes back.
  const bool passes = admission.role == Role::kAdmin || !admission.hello.resume.empty();
  switch (shown_stage_.load()) {
    case LifeStage::kRunning:
    case LifeStage::kPaused:
      if (shown_locked_ && !passes) {
        return protocol::Refused{protocol::Refusal::kRoomLocked, "room " + name_ + " is locked"};
      }
      return full(admission);
    case LifeStage::kDraining:
      return protocol::Refused{protocol::Refusal::kDraining, "room " + name_ + " is draining"};
    case LifeStage::kEnded:
      return protocol::Refused{protocol::Refusal::kDraining, "room " + name_ + " has ended"};
  }
  return std::nullopt;
}

std::optional<protocol::Refused> HostedRoom::full(const Admission& admission) const {
  if (shown_full_) {
    return protocol::Refused{protocol::Refusal::kRoomFull,
                             "room " + name_ + " takes no more connections"};
  }
  const bool any_seat = admission.role != Role::kSpectator && admission.hello.resume.empty() &&
                        admission.seat == protocol::kAnySeat &&
                        admission.hello.seat_wish == protocol::kAnySeat;
  if (!any_seat || !shown_seats_full_) return std::nullopt;
  const std::string all = std::to_string(seats_);
  return protocol::Refused{protocol::Refusal::kRoomFull, all + " seats taken, of " + all};
}

void HostedRoom::publish_stage() {
  shown_stage_ = life_.stage();
  shown_locked_ = life_.locked();
}

void HostedRoom::publish() {
  const RoomStatistics& statistics = room_->statistics();
  meters_.tick.set(room_->tick());
  meters_.digest.set(room_->digest());
  meters_.clients.set(room_->peers());
  show_places();
  meters_.joined.set(statistics.clients);
  meters_.desyncs.set(statistics.desyncs);
  meters_.inquiries_skipped.set(inquiry_->desk().counts().skipped);
  meters_.inputs_late.set(statistics.inputs_late);
  meters_.inputs_early.set(statistics.inputs_early);
  meters_.bytes_in.set(statistics.bytes_in);
  meters_.bytes_out.set(statistics.bytes_out);
  meters_.slowed_ns.set(statistics.slowed_ns);
  meters_.inputs_replaced.set(statistics.inputs_replaced);
  meters_.catch_up_ticks.set(statistics.catch_up_ticks);
  meters_.encodes.set(statistics.encodes);
  meters_.queue_bytes.set(statistics.queue_bytes);
  for (std::size_t code = 0; code < statistics.refusals_by_code.size(); ++code) {
    meters_.refusals[code].set(statistics.refusals_by_code[code]);
  }
  if (log_ != nullptr) meters_.durable.set(log_->durable() ? 1 : 0);
}

ServeReport HostedRoom::report() const {
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

}  // namespace cycloid::server
