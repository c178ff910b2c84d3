#include "protocol/state/quantised_delta.hpp"

#include <algorithm>

#include "protocol/state/priority.hpp"
#include "protocol/state/quantised_coder.hpp"

namespace cycloid::protocol {
namespace {

constexpr unsigned kFormat = 1;  ///< Raise it with any change of what a delta says.
constexpr unsigned kSpatialBit = 1;
constexpr unsigned kBaselineBit = 2;
constexpr unsigned kVelocitiesBit = 4;

template <class Coder>
class CharacterCoder {
 public:
  using List = std::conditional_t<Coder::kReads, std::vector<QuantisedCharacter>,
                                  const std::vector<QuantisedCharacter>>;

  CharacterCoder(Coder& coder, std::uint8_t dimension) : coder_(coder), dimension_(dimension) {}

  bool code(const std::vector<QuantisedCharacter>& base, List& now) {
    const auto guess = static_cast<std::int32_t>(base.size());
    const auto said = static_cast<std::int32_t>(now.size());
    const auto count = static_cast<std::uint32_t>(code_steps(coder_, count_, guess, said));
    if (count > scenes::kSeatsMax) return false;
    if constexpr (Coder::kReads) now.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const QuantisedCharacter from = i < base.size() ? base[i] : QuantisedCharacter{};
      QuantisedCharacter character = now[i];
      const bool changed = coder_.bit(changed_, character != from);
      if (changed) code_changed(from, character);
      if constexpr (Coder::kReads) now[i] = changed ? character : from;
    }
    return good_;
  }

 private:
  void code_changed(const QuantisedCharacter& from, QuantisedCharacter& character) {
    for (std::size_t i = 0; i < dimension_; ++i) {
      character.position[i] =
          code_steps(coder_, position_[i], from.position[i], character.position[i]);
      const std::int32_t speed =
          code_steps(coder_, velocity_[i], from.velocity[i], character.velocity[i]);
      if (speed < INT16_MIN || speed > INT16_MAX) good_ = false;
      character.velocity[i] = static_cast<std::int16_t>(speed);
    }
    character.grounded = coder_.bit(grounded_[from.grounded ? 1 : 0], character.grounded);
  }

  Coder& coder_;
  std::uint8_t dimension_;
  bool good_ = true;
  std::array<StepModel, 3> position_;
  std::array<StepModel, 3> velocity_;
  std::array<AdaptiveBit, 2> grounded_;
  AdaptiveBit changed_;
  StepModel count_;
};

/// All lists, in either direction. `State` is const where it is said.
template <class Coder, class State>
bool code_lists(Coder& coder, bool velocities, const QuantisedState& base, std::size_t bodies_max,
                State& now) {
  if (!CharacterCoder<Coder>(coder, now.dimension).code(base.characters, now.characters))
    return false;
  const BodyForm bodies{now.dimension, true, velocities};
  if (!ListCoder<Coder>(coder, bodies).code(base.bodies, bodies_max, now.bodies)) return false;
  const BodyForm particles{now.dimension, false, velocities};
  return ListCoder<Coder>(coder, particles).code(base.particles, bodies_max, now.particles);
}

bool has_velocities(const QuantisedState& state) {
  const auto moves = [](const QuantisedBody& body) {
    return body.velocity != QuantisedBody{}.velocity || body.spin != QuantisedBody{}.spin;
  };
  return std::any_of(state.bodies.begin(), state.bodies.end(), moves) ||
         std::any_of(state.particles.begin(), state.particles.end(), moves);
}

/// The delta from what is held to what shall be; empty where they show the same.
std::vector<std::byte> bytes_between(const QuantisedState* base, const QuantisedState& held) {
  const QuantisedState nothing{0, held.dimension, {}, {}, {}};
  const QuantisedState& from = base == nullptr ? nothing : *base;
  std::vector<std::byte> bytes;
  if (base != nullptr && shows_the_same(from, held)) return bytes;
  const bool velocities = has_velocities(from) || has_velocities(held);
  bytes.push_back(static_cast<std::byte>(kFormat << 4 | (held.dimension == 3 ? kSpatialBit : 0u) |
                                         (base != nullptr ? kBaselineBit : 0u) |
                                         (velocities ? kVelocitiesBit : 0u)));
  SayingCoder coder(bytes);
  const std::size_t any =
      from.bodies.size() + held.bodies.size() + from.particles.size() + held.particles.size();
  code_lists(coder, velocities, from, any, held);
  coder.finish();
  return bytes;
}

}  // namespace

QuantisedDelta encode_quantised(const HeldState* baseline, const QuantisedState& now,
                                std::size_t bytes_max) {
  bytes_max = std::max(bytes_max, kBudgetBytesMin);
  const QuantisedState* base = baseline == nullptr ? nullptr : &baseline->state;
  QuantisedDelta all{bytes_between(base, now), {now, {}}};
  if (all.bytes.size() <= bytes_max) return all;
  const HeldState nothing{{now.tick, now.dimension, {}, {}, {}}, {}};
  const HeldState& from = baseline == nullptr ? nothing : *baseline;
  const std::vector<PendingChange> changes = changes_by_urgency(from, now);
  // `fits` changes fit, `too_many` do not. No change always fits: that takes a byte at most.
  std::size_t fits = 0;
  std::size_t too_many = changes.size();
  QuantisedDelta best{{}, with_changes(from, now, changes, 0)};
  while (fits + 1 < too_many) {
    const std::size_t count = fits + (too_many - fits) / 2;
    HeldState held = with_changes(from, now, changes, count);
    std::vector<std::byte> bytes = bytes_between(base, held.state);
    if (bytes.size() > bytes_max) {
      too_many = count;
    } else {
      fits = count;
      best = {std::move(bytes), std::move(held)};
    }
  }
  return best;
}

std::optional<QuantisedState> decode_quantised(const QuantisedState* baseline, std::uint64_t tick,
                                               std::span<const std::byte> bytes,
                                               std::size_t bodies_max) {
  QuantisedState state;
  state.tick = tick;
  if (bytes.empty()) {
    if (baseline == nullptr) return std::nullopt;
    state = *baseline;
    state.tick = tick;
    return state;
  }
  const auto head = static_cast<unsigned>(bytes[0]);
  state.dimension = (head & kSpatialBit) != 0 ? 3 : 2;
  const bool velocities = (head & kVelocitiesBit) != 0;
  if (head >> 3 != kFormat << 1) return std::nullopt;
  if (((head & kBaselineBit) != 0) != (baseline != nullptr)) return std::nullopt;
  if (baseline != nullptr && baseline->dimension != state.dimension) return std::nullopt;
  const QuantisedState nothing{0, state.dimension, {}, {}, {}};
  HearingCoder coder(bytes.subspan(1));
  if (!code_lists(coder, velocities, baseline == nullptr ? nothing : *baseline, bodies_max, state))
    return std::nullopt;
  if (coder.has_more()) return std::nullopt;
  return state;
}

}  // namespace cycloid::protocol
