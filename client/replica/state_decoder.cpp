#include "client/replica/state_decoder.hpp"

#include <span>
#include <utility>

#include "protocol/state/exact_delta.hpp"
#include "protocol/state/quantised_delta.hpp"

namespace cycloid::client {

/// Bodies, and particles, of one quantised state.
static constexpr std::size_t kBodiesMax = std::size_t{1} << 16;

std::string DeltaDecoder::decode(const protocol::StateDelta& delta, const DecodedState* baseline,
                                 DecodedState& into) {
  into = {};
  into.tick = delta.tick;
  return delta.profile == protocol::Profile::kExact ? decode_exact(delta, baseline, into)
                                                    : decode_quantised(delta, baseline, into);
}

std::string DeltaDecoder::decode_exact(const protocol::StateDelta& delta,
                                       const DecodedState* baseline, DecodedState& into) const {
  const std::span<const std::byte> from =
      baseline == nullptr ? std::span<const std::byte>() : baseline->exact;
  auto exact = protocol::decode_exact_delta(from, delta.bytes, exact_bytes_max_);
  if (!exact) return "not of its baseline, or damaged";
  into.exact = std::move(*exact);
  return "";
}

std::string DeltaDecoder::decode_quantised(const protocol::StateDelta& delta,
                                           const DecodedState* baseline, DecodedState& into) {
  const protocol::QuantisedState* from = baseline == nullptr ? nullptr : &baseline->quantised;
  auto state = protocol::decode_quantised(from, delta.tick, delta.bytes, kBodiesMax);
  if (!state) return "not of its baseline, or damaged";
  if (protocol::digest_of(*state) != delta.digest) return "not of the digest that it says";
  into.quantised = std::move(*state);
  return "";
}

}  // namespace cycloid::client
