#include "client/visit.hpp"

#include <algorithm>
#include <utility>

#include "client/net/attempt.hpp"
#include "client/replica/replica.hpp"

namespace cycloid::client {
namespace {

std::uint64_t steady_ns() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::nanoseconds(now).count());
}

/// Why a scene cannot run: its own first mistake, if it has one.
std::string scene_reason(const scenes::Scene& scene, const solver::Error& error) {
  const std::vector<scenes::Mistake> mistakes = scenes::check(scene);
  return "the scene cannot run: " +
         (mistakes.empty() ? error.field : mistakes.front().path + ": " + mistakes.front().reason);
}

/// What may be otherwise in a moment: the old connection of our own seat may still hold it.
bool may_pass(protocol::Refusal code) {
  switch (code) {
    case protocol::Refusal::kTooSlow:
    case protocol::Refusal::kSeatTaken:
    case protocol::Refusal::kRoomFull:
    case protocol::Refusal::kRateLimited:
    case protocol::Refusal::kDraining:
      return true;
    default:  // kReplaced, kKicked: somebody meant it. The rest stays as it is.
      return false;
  }
}

/// Adds the counts of an earlier connection; what is not a count stays.
void add_counts(const Progress& before, Progress& now) {
  if (before.begun()) now.first_tick = before.first_tick;
  if (!now.begun()) now.last_tick = before.last_tick;
  now.frames += before.frames;
  now.snapshots += before.snapshots;
  now.states_kept += before.states_kept;
  now.digests_compared += before.digests_compared;
  now.mismatches += before.mismatches;
  now.resyncs += before.resyncs;
  now.rewinds += before.rewinds;
  now.inputs_sent += before.inputs_sent;
  now.inputs_replaced += before.inputs_replaced;
  now.deltas_dropped += before.deltas_dropped;
}

void add_counts(const PredictorStatistics& of, PredictorStatistics& sum) {
  sum.rollbacks += of.rollbacks;
  sum.resimulated += of.resimulated;
  sum.deepest_ticks = std::max(sum.deepest_ticks, of.deepest_ticks);
  sum.stalls += of.stalls;
  sum.faults += of.faults;
}

}  // namespace

Visit::Visit(JoinOptions options)
    : options_(std::move(options)),
      backoff_(options_.reconnect.first, options_.reconnect.longest, options_.reconnect.seed),
      resume_(options_.resume),
      room_(options_.room) {
  std::string mistake = mistake_of(options_);
  if (mistake.empty())
    begin(std::chrono::milliseconds(0));
  else
    fail(std::move(mistake));
}

Visit::~Visit() {
  if (attempt_ == nullptr) return;
  stop();
  while (!attempt_->over()) attempt_->poll(std::chrono::milliseconds(100));
}

void Visit::begin(std::chrono::milliseconds wait) {
  attempt_.reset();  // Counted already; and the options that it looks at change below.
  working_since_.reset();
  auto simulation = scenes::Simulation::create(options_.scene);
  solver::Error error = simulation.ok() ? solver::Error{} : simulation.error();
  if (error.ok()) error = simulation.value().set_workers_at_most(options_.workers, &steady_ns);
  if (!error.ok()) return fail(scene_reason(options_.scene, error));
  options_.resume = resume_;
  options_.room = room_;
  if (has_kept_) simulation.value().restore(kept_);
  attempt_ = std::make_unique<Attempt>(options_, std::move(simulation.value()), has_kept_, wait);
  if (report_.progress.begun()) attempt_->count_from(report_.progress.first_tick);
}

void Visit::fail(std::string reason) {
  report_.end = End::kFailed;
  report_.reason = std::move(reason);
  over_ = true;
}

void Visit::poll(std::chrono::milliseconds wait) {
  if (over_) return;
  attempt_->poll(wait);
  keep_welcome();
  if (attempt_->over()) attempt_ended();
}

/// Notes what the next connection needs, and that this one works.
void Visit::keep_welcome() {
  if (!attempt_->follower().welcomed()) return;
  const protocol::Welcome& welcome = attempt_->follower().welcome();
  resume_ = welcome.resume;
  room_ = welcome.room.empty() ? options_.room : welcome.room;
  welcomed_ = true;
  if (!attempt_->follower().progress().begun()) return;
  const auto now = Clock::now();
  if (!working_since_) working_since_ = now;
  if (broken_) {
    ++report_.reconnects;
    if (forgotten_) ++report_.fresh_joins;
  }
  broken_.reset();
  forgotten_ = false;
  // A server that breaks down again at once is not asked again at once.
  if (now - *working_since_ >= options_.reconnect.longest) backoff_.reset();
}

void Visit::attempt_ended() {
  keep_welcome();
  const bool again = !stopping_ && options_.reconnect.on && welcomed_ && comes_back(*attempt_);
  if (!again) {
    over_ = true;
    return;
  }
  const auto now = Clock::now();
  if (!broken_) broken_ = now;
  const auto wait = backoff_.next();
  if (now + wait > *broken_ + options_.reconnect.deadline) {
    over_ = true;
    return;
  }
  count(*attempt_);
  keep_state(attempt_->follower());
  ++report_.tries;
  begin(wait);
}

/// Keeps what a later connection can go on from: of this one, or of an older one where this one has
/// come to nothing.
void Visit::keep_state(const Follower& ended) {
  if (resume_.empty())
    has_kept_ = false;
  else if (ended.keep(kept_))
    has_kept_ = true;
  else if (ended.progress().begun())
    has_kept_ = false;
}

bool Visit::comes_back(const Attempt& ended) {
  if (ended.end() == End::kDisconnected) return true;
  if (ended.end() != End::kRefused) return false;
  const protocol::Refusal code = ended.follower().progress().refused->code;
  if (code != protocol::Refusal::kResumeUnknown) return may_pass(code);
  if (!options_.reconnect.fresh_join || resume_.empty()) return false;
  resume_.clear();
  forgotten_ = true;
  return true;
}

/// Adds an attempt that is over to the report.
void Visit::count(const Attempt& ended) {
  Progress now = ended.follower().progress();
  add_counts(report_.progress, now);
  report_.progress = now;
  if (ended.follower().progress().begun()) report_.final_digest = ended.follower().digest();
  report_.bytes_in += ended.connection().bytes_in();
  report_.bytes_out += ended.connection().bytes_out();
  const auto* replica = dynamic_cast<const Replica*>(&ended.follower());
  if (replica != nullptr && replica->predictor() != nullptr) {
    add_counts(replica->predictor()->statistics(), report_.prediction);
  }
}

JoinReport Visit::report() const {
  if (attempt_ == nullptr) return report_;
  JoinReport report = report_;
  report.end = attempt_->end();
  report.reason = attempt_->reason();
  Progress now = attempt_->follower().progress();
  add_counts(report_.progress, now);
  report.progress = now;
  const bool older = !attempt_->follower().progress().begun() && report_.tries != 0;
  if (!older) report.final_digest = attempt_->follower().digest();
  report.bytes_in += attempt_->connection().bytes_in();
  report.bytes_out += attempt_->connection().bytes_out();
  const auto* replica = dynamic_cast<const Replica*>(&attempt_->follower());
  if (replica != nullptr && replica->predictor() != nullptr) {
    add_counts(replica->predictor()->statistics(), report.prediction);
  }
  return report;
}

void Visit::stop() {
  stopping_ = true;
  if (attempt_ != nullptr) attempt_->stop();
}

Follower* Visit::follower() {
  return attempt_ == nullptr ? nullptr : &attempt_->follower();
}
const Follower* Visit::follower() const {
  return attempt_ == nullptr ? nullptr : &attempt_->follower();
}

}  // namespace cycloid::client
