#include "client/replica/state_decoder.hpp"

namespace cycloid::client {

std::string ExactDecoder::decode(const protocol::StateDelta& delta, const DecodedState* baseline,
                                 DecodedState& into) {
  if (delta.profile != protocol::Profile::kExact) return "not of the exact profile";
  if (baseline != nullptr || delta.baseline_tick != 0) return "not a whole state";
  into.tick = delta.tick;
  into.exact = delta.bytes;
  into.poses.clear();
  into.quantised.clear();
  return "";
}

}  // namespace cycloid::client
