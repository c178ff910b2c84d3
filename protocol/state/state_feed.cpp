#include "protocol/state/state_feed.hpp"

#include <algorithm>

#include "protocol/state/exact_delta.hpp"

namespace cycloid::protocol {

void StateFeed::advance(const scenes::Simulation& simulation, std::uint64_t digest) {
  made_.clear();
  Stored stored;
  if (options_.profile == Profile::kExact) {
    simulation.encode(stored.exact);
  } else {
    stored.quantised.state = capture(simulation, options_.capture);
    digest = digest_of(stored.quantised.state);
  }
  now_ = {simulation.tick(), digest};
  state_ = std::make_shared<const Stored>(std::move(stored));
  history_.put(now_, state_);
}

std::shared_ptr<const FeedDelta> StateFeed::delta(const std::optional<StateKey>& baseline) {
  std::shared_ptr<const Stored> from;
  if (baseline && baseline->tick < now_.tick) from = history_.find(*baseline);
  // Tick 0 stands for nothing on the wire, so the state before the first tick is no baseline.
  const StateKey key = from != nullptr && baseline->tick > 0 ? *baseline : StateKey{};
  if (key.tick == 0) from = nullptr;
  std::shared_ptr<const FeedDelta>& made = made_[key];
  if (made == nullptr) {
    FeedDelta delta;
    code(key, from.get(), delta);
    made = std::make_shared<const FeedDelta>(std::move(delta));
    ++encodes_;
  }
  return made;
}

void StateFeed::code(const StateKey& key, const Stored* baseline, FeedDelta& into) {
  into.message.tick = now_.tick;
  into.message.baseline_tick = key.tick;
  into.message.profile = options_.profile;
  into.held = now_;
  if (options_.profile == Profile::kExact) {
    const std::vector<std::byte> none;
    encode_exact_delta(baseline == nullptr ? none : baseline->exact, state_->exact,
                       into.message.bytes);
  } else {
    QuantisedDelta made = encode_quantised(baseline == nullptr ? nullptr : &baseline->quantised,
                                           state_->quantised.state, options_.budget_bytes);
    into.changes = !made.bytes.empty();
    into.message.bytes = std::move(made.bytes);
    if (!made.held.waiting.empty()) {
      into.held.digest = digest_of(made.held.state);
      history_.put(into.held, std::make_shared<const Stored>(Stored{{}, std::move(made.held)}));
    }
  }
  into.message.digest = into.held.digest;
}

void StateFeed::forget_all() {
  history_.clear();
  made_.clear();
}

void SentStates::sent(const StateKey& held) {
  while (!sent_.empty() && sent_.back().tick >= held.tick) sent_.pop_back();
  sent_.push_back(held);
  if (sent_.size() > kSentMax) sent_.pop_front();
}

bool SentStates::acknowledge(std::uint64_t tick) {
  const auto at = std::find_if(sent_.begin(), sent_.end(),
                               [&](const StateKey& key) { return key.tick == tick; });
  if (at == sent_.end()) return false;
  baseline_ = *at;
  sent_.erase(sent_.begin(), at + 1);
  return true;
}

}  // namespace cycloid::protocol
