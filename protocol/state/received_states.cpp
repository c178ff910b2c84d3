#include "protocol/state/received_states.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "protocol/state/exact_delta.hpp"
#include "protocol/state/quantised_delta.hpp"

namespace cycloid::protocol {

std::string ReceivedStates::take(const StateDelta& message) {
  if (message.profile != profile_) return "a state of the other profile";
  if (message.tick < tick())
    return "a state of tick " + std::to_string(message.tick) + ", here is " +
           std::to_string(tick()) + " already";
  const Held* base = message.baseline_tick == 0 ? nullptr : find(message.baseline_tick);
  if (base == nullptr && message.baseline_tick != 0)
    return "a state against tick " + std::to_string(message.baseline_tick) +
           ", which is not held here";
  Held held{message.tick, {}, {}};
  if (profile_ == Profile::kExact) {
    const std::vector<std::byte> none;
    auto state = decode_exact_delta(base == nullptr ? none : base->exact, message.bytes,
                                    limits_.exact_bytes_max);
    if (!state) return "a damaged state of tick " + std::to_string(message.tick);
    held.exact = std::move(*state);
  } else {
    auto state = decode_quantised(base == nullptr ? nullptr : &base->quantised, message.tick,
                                  message.bytes, limits_.bodies_max);
    if (!state || digest_of(*state) != message.digest)
      return "a damaged state of tick " + std::to_string(message.tick);
    held.quantised = std::move(*state);
  }
  while (!held_.empty() && held_.front().tick < message.baseline_tick) held_.pop_front();
  forget_from(message.tick);
  put(std::move(held));
  return "";
}

void ReceivedStates::hold(std::uint64_t tick, std::vector<std::byte> exact,
                          QuantisedState quantised) {
  forget_from(tick);
  if (profile_ == Profile::kExact)
    put({tick, std::move(exact), {}});
  else
    put({tick, {}, std::move(quantised)});
}

const ReceivedStates::Held* ReceivedStates::find(std::uint64_t tick) const {
  const auto at = std::lower_bound(held_.begin(), held_.end(), tick,
                                   [](const Held& held, std::uint64_t t) { return held.tick < t; });
  return at == held_.end() || at->tick != tick ? nullptr : &*at;
}

std::size_t ReceivedStates::bytes_of(const Held& held) {
  return held.exact.capacity() + size_bytes(held.quantised);
}

void ReceivedStates::forget_from(std::uint64_t tick) {
  while (!held_.empty() && held_.back().tick >= tick) held_.pop_back();
}

void ReceivedStates::put(Held held) {
  held_.push_back(std::move(held));
  std::size_t held_bytes = bytes();
  // The newest always stays: it is what is shown. The first is what the server builds on now.
  while (held_.size() > 1 &&
         (held_.size() > limits_.states_max || held_bytes > limits_.held_bytes_max)) {
    const auto oldest = held_.begin() + (held_.size() > 2 ? 1 : 0);
    held_bytes -= bytes_of(*oldest);
    held_.erase(oldest);
  }
}

std::size_t ReceivedStates::bytes() const {
  std::size_t sum = 0;
  for (const Held& held : held_) sum += bytes_of(held);
  return sum;
}

}  // namespace cycloid::protocol
