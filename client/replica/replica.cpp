#include "client/replica/replica.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::client {

Replica::Replica(scenes::Simulation simulation, FollowerOptions options)
    : Follower(protocol::Mode::kLockstep, std::move(simulation), std::move(options)) {
  if (this->options().predict_ticks == 0) return;
  predictor_ = std::make_unique<Predictor>(
      simulation_, PredictorOptions{this->options().predict_ticks, protocol::kSpectator,
                                    this->options().one_shot});
}

void Replica::on_seated() {
  newest_tick_ = counted_tick_ = base_tick();
  if (predictor_) predictor_->sit(progress_.seat);
}

void Replica::on_kept() {
  if (predictor_) predictor_->reset(false);
  if (options().witness) options().witness->replaced(simulation_);
}

bool Replica::keep(scenes::Simulation::Saved& into) const {
  if (progress_.phase != Phase::kRunning || diverged_) return false;
  if (!predictor_) {
    simulation_.save(into);
    return true;
  }
  return predictor_->with_confirmed([&](const scenes::Simulation& confirmed) {
    confirmed.save(into);
    return true;
  });
}

void Replica::on_said(std::uint64_t tick, const scenes::SeatInput& input) {
  if (predictor_) predictor_->hear(tick, input);
}

void Replica::settle() {
  if (predictor_ && progress_.phase == Phase::kRunning) predictor_->settle();
}

bool Replica::advance(Outbox& out) {
  if (!predictor_ || progress_.phase != Phase::kRunning || predictor_->full()) return false;
  const std::uint64_t before = next_input_tick();
  send_inputs(before, 1, out);
  settle();
  return next_input_tick() != before;
}

std::uint64_t Replica::digest() const {
  if (!predictor_) return simulation_.digest();
  return predictor_->with_confirmed([](const auto& confirmed) { return confirmed.digest(); });
}

/// Whether frames lead from the state of `tick` to the newest frame; the session fails if not.
bool Replica::can_follow(std::uint64_t tick) {
  const std::uint64_t oldest = newest_tick_ - frames_.size();
  if (tick >= oldest) return true;
  fail("the snapshot of tick " + std::to_string(tick) +
       " is older than the frames that are kept, from tick " + std::to_string(oldest + 1));
  return false;
}

void Replica::on_exact(const protocol::Snapshot& state, Outbox& out) {
  if (!can_follow(state.tick) || !load(state.tick, state.digest, state.state)) return;
  if (predictor_) predictor_->reset(went_back_);
  went_back_ = false;
  if (diverged_) ++progress_.resyncs;
  diverged_ = false;
  if (options().witness) options().witness->replaced(simulation_);
  compare_waiting(out);
  if (state.tick >= newest_tick_) {
    frames_.clear();
    newest_tick_ = state.tick;
  }
  for (const protocol::InputFrame& frame : frames_) {
    if (frame.tick > state.tick && !step(frame, out)) return;
  }
  send_inputs(progress_.last_tick + lead(), kBurst, out);
}

/// A server that could not hand its frames over drops them and begins an exact state in their
/// place; frames from behind that state on may come between its parts.
void Replica::skip_to_state_before(std::uint64_t tick) {
  const auto assembling = assembling_tick();
  if (!assembling || tick != *assembling + 1 || tick <= newest_tick_ + 1) return;
  frames_.clear();
  newest_tick_ = *assembling;
  progress_.phase = Phase::kLoading;
}

void Replica::on_frame(const protocol::InputFrame& frame, Outbox& out) {
  skip_to_state_before(frame.tick);
  const std::uint64_t expected = newest_tick_ + 1;
  if (frame.tick != expected) {
    return fail("a gap: the frame of tick " + std::to_string(frame.tick) + " instead of " +
                std::to_string(expected));
  }
  if (loading() && frames_.size() >= options().frames_waiting_max) {
    return fail("more than " + std::to_string(options().frames_waiting_max) +
                " frames before the snapshot that they go on from");
  }
  newest_tick_ = frame.tick;
  frames_.push_back(frame);
  if (loading()) return;

  const auto assembling = assembling_tick();
  while (frames_.size() > kFramesKept && (!assembling || frames_.front().tick <= *assembling)) {
    frames_.pop_front();
  }
  if (frames_.size() > kFramesKept + options().frames_waiting_max) {
    return fail("more than " + std::to_string(options().frames_waiting_max) +
                " frames beside a snapshot in parts");
  }
  if (step(frame, out)) send_inputs(frame.tick + lead(), kBurst, out);
}

bool Replica::step(const protocol::InputFrame& frame, Outbox& out) {
  inputs_.clear();
  for (const protocol::SeatFrame& seat : frame.seats) inputs_.push_back(seat.input);
  witness_leaving(out);
  const solver::Error error = predictor_ ? predictor_->confirm(inputs_) : simulation_.step(inputs_);
  if (!error.ok()) {
    fail("the world does not step to tick " + std::to_string(frame.tick) + ": " +
         solver::code_name(error.code) + " " + error.field);
    return false;
  }
  progress_.last_tick = frame.tick;
  witness_confirmed();
  if (frame.tick > counted_tick_) {  // Else it is stepped again, from an older exact state.
    counted_tick_ = frame.tick;
    take_frame(frame);
  }
  compare_waiting(out);
  return true;
}

void Replica::witness_confirmed() {
  Witness* witness = options().witness.get();
  if (witness == nullptr) return;
  if (!predictor_) return witness->confirmed(simulation_);
  predictor_->with_confirmed([witness](const scenes::Simulation& confirmed) {
    witness->confirmed(confirmed);
    return true;
  });
}

void Replica::witness_leaving(Outbox& out) {
  Witness* witness = options().witness.get();
  if (witness == nullptr) return;
  if (!predictor_) return witness->leaving(simulation_, out);
  predictor_->with_confirmed([&](const scenes::Simulation& confirmed) {
    witness->leaving(confirmed, out);
    return true;
  });
}

void Replica::on_rewound(std::uint64_t tick) {
  went_back_ = true;
  frames_.clear();
  waiting_.clear();
  newest_tick_ = counted_tick_ = tick;
  diverged_ = false;
}

void Replica::on_delta(const protocol::StateDelta& delta, Outbox&) {
  fail("a delta of tick " + std::to_string(delta.tick) + " for a lockstep client");
}

void Replica::on_digest(const protocol::Digest& digest, Outbox& out) {
  if (!waiting_.empty() && digest.tick <= waiting_.back().tick) {
    return fail("the digest of tick " + std::to_string(digest.tick) + " came after that of " +
                std::to_string(waiting_.back().tick));
  }
  if (waiting_.size() == kDigestsWaitingMax) return fail("too many digests of ticks to come");
  waiting_.push_back(digest);
  if (!loading()) compare_waiting(out);
}

void Replica::compare_waiting(Outbox& out) {
  while (!waiting_.empty() && waiting_.front().tick <= progress_.last_tick) {
    const protocol::Digest theirs = waiting_.front();
    waiting_.pop_front();
    if (theirs.tick < progress_.last_tick) continue;  // That state is gone.

    const protocol::Digest mine{theirs.tick, digest()};
    ++progress_.digests_compared;
    out.emplace_back(mine);
    if (mine.digest == theirs.digest) {
      if (options().witness) options().witness->agreed(theirs.tick);
      continue;
    }
    ++progress_.mismatches;
    diverged_ = true;
    witness_leaving(out);
    if (options().witness) options().witness->diverged(theirs.tick, out);
  }
}

}  // namespace cycloid::client
