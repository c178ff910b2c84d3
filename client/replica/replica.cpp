#include "client/replica/replica.hpp"

#include <utility>

namespace cycloid::client {

Replica::Replica(scenes::Simulation simulation, FollowerOptions options)
    : Follower(protocol::Mode::kLockstep, std::move(simulation), std::move(options)) {}

void Replica::on_snapshot(const protocol::Snapshot& snapshot, Outbox& out) {
  if (!load(snapshot)) return;
  if (diverged_) ++progress_.resyncs;
  diverged_ = false;
  evidence_.replaced(snapshot.tick);
  compare_waiting(out);
  send_inputs(snapshot.tick + input_delay(), out);
}

void Replica::on_frame(const protocol::InputFrame& frame, Outbox& out) {
  const std::uint64_t expected = simulation_.tick() + 1;
  if (frame.tick != expected) {
    return fail("a gap: the frame of tick " + std::to_string(frame.tick) + " instead of " +
                std::to_string(expected));
  }
  if (!check_frame(frame)) return;

  inputs_.clear();
  for (const protocol::SeatFrame& seat : frame.seats) inputs_.push_back(seat.input);
  evidence_.record(simulation_);
  if (const solver::Error error = simulation_.step(inputs_); !error.ok()) {
    return fail("the world does not step to tick " + std::to_string(frame.tick) + ": " +
                solver::code_name(error.code) + " " + error.field);
  }
  progress_.last_tick = frame.tick;
  count_frame(frame);
  compare_waiting(out);
  evidence_.send_parts(out);
  send_inputs(frame.tick + input_delay(), out);
}

void Replica::on_digest(const protocol::Digest& digest, Outbox& out) {
  if (!waiting_.empty() && digest.tick <= waiting_.back().tick) {
    return fail("the digest of tick " + std::to_string(digest.tick) + " came after that of " +
                std::to_string(waiting_.back().tick));
  }
  if (waiting_.size() == kDigestsWaitingMax) return fail("too many digests of ticks to come");
  waiting_.push_back(digest);
  compare_waiting(out);
}

void Replica::on_state_wanted(const protocol::StateWanted& wanted) {
  evidence_.wanted(wanted.tick, simulation_);
}

void Replica::compare_waiting(Outbox& out) {
  while (!waiting_.empty() && waiting_.front().tick <= simulation_.tick()) {
    const protocol::Digest theirs = waiting_.front();
    waiting_.pop_front();
    if (theirs.tick < simulation_.tick()) continue;  // That state is gone.

    const protocol::Digest mine{theirs.tick, simulation_.digest()};
    ++progress_.digests_compared;
    out.emplace_back(mine);
    if (mine.digest == theirs.digest) {
      evidence_.agreed(theirs.tick);
      continue;
    }
    ++progress_.mismatches;
    diverged_ = true;
    evidence_.record(simulation_);
    evidence_.diverged(theirs.tick, simulation_, out);
  }
}

}  // namespace cycloid::client
