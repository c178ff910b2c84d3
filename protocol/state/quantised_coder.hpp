#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <vector>

#include "protocol/state/quantised.hpp"
#include "protocol/state/quantised_rotation.hpp"
#include "protocol/state/word_coder.hpp"

namespace cycloid::protocol {

/// A small number as its distance from a guess: the width of the magnitude counted up from 0, the
/// sign, the bit below the highest, then noise. Learns faster than DistanceModel, because a delta
/// of poses is a few hundred bytes in all.
struct StepModel {
  std::array<AdaptiveBit, 33> wider;
  std::array<AdaptiveBit, 33> next;
  AdaptiveBit negative;
};

/// @returns guess + the distance that was said, modulo 2^32.
template <class Coder>
std::int32_t code_steps(Coder& coder, StepModel& model, std::int32_t guess, std::int32_t value) {
  const std::uint32_t distance =
      static_cast<std::uint32_t>(value) - static_cast<std::uint32_t>(guess);
  const std::uint32_t said = distance >> 31 != 0 ? 0u - distance : distance;
  const auto wanted = static_cast<unsigned>(std::bit_width(said));
  unsigned width = 0;
  while (width < 32 && coder.bit(model.wider[width], width < wanted)) ++width;
  if (width == 0) return guess;
  const bool negative = coder.bit(model.negative, distance >> 31 != 0);
  std::uint32_t magnitude = 1;
  if (width > 1) {
    const bool next = coder.bit(model.next[width], (said >> (width - 2) & 1u) != 0);
    magnitude = 2u | static_cast<std::uint32_t>(next);
  }
  if (width > 2) {
    const std::uint32_t below = (1u << (width - 2)) - 1u;
    magnitude = magnitude << (width - 2) | coder.raw(said & below, width - 2);
  }
  const std::uint32_t said_distance = negative ? 0u - magnitude : magnitude;
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(guess) + said_distance);
}

/// Which of a body's numbers a list has.
struct BodyForm {
  std::uint8_t dimension = 3;
  bool turns = true;
  bool velocities = false;
};

/// Codes bodies against guesses, and learns from each for the next.
template <class Coder>
class BodyCoder {
 public:
  BodyCoder(Coder& coder, const BodyForm& form) : coder_(coder), form_(form) {}

  /// All but index and generation. @pre `body` is good where it is said; where it is heard,
  /// `is_good` may be false afterwards.
  void code(const QuantisedBody& guess, QuantisedBody& body) {
    body.at_rest = coder_.bit(at_rest_[guess.at_rest ? 1 : 0], body.at_rest);
    std::size_t context = 0;
    for (std::size_t i = 0; i < form_.dimension; ++i) {
      body.position[i] =
          code_steps(coder_, position_[i][context], guess.position[i], body.position[i]);
      context = 1 + bucket_of(body.position[i] - std::int64_t{guess.position[i]});
    }
    if (form_.turns && form_.dimension == 2) code_angle(guess, body);
    if (form_.turns && form_.dimension == 3) code_rotation(guess, body);
    if (form_.velocities) code_velocities(guess, body);
  }

  bool is_good() const { return good_; }

 private:
  static std::size_t bucket_of(std::int64_t distance) {
    const std::int64_t magnitude = distance < 0 ? -distance : distance;
    return magnitude < 2 ? 0 : magnitude < 16 ? 1 : 2;
  }

  std::int16_t code_small(StepModel& model, std::int32_t guess, std::int16_t value) {
    const std::int32_t steps = code_steps(coder_, model, guess, value);
    if (steps < INT16_MIN || steps > INT16_MAX) good_ = false;
    return static_cast<std::int16_t>(steps);
  }

  void code_angle(const QuantisedBody& guess, QuantisedBody& body) {
    const std::int32_t from = guess.rotation.parts[0];
    std::int32_t distance = body.rotation.parts[0] - from;
    if (2 * distance > kAngleSteps) distance -= kAngleSteps;
    if (2 * distance <= -kAngleSteps) distance += kAngleSteps;
    distance = code_steps(coder_, rotation_[0], 0, distance);
    if constexpr (!Coder::kReads) return;
    if (distance <= -kAngleSteps || distance >= kAngleSteps) good_ = false;
    const std::int64_t to = std::int64_t{from} + distance + kAngleSteps;
    body.rotation.parts[0] = static_cast<std::int16_t>(to % kAngleSteps);
  }

  void code_rotation(const QuantisedBody& guess, QuantisedBody& body) {
    QuantisedRotation& rotation = body.rotation;
    const bool other = coder_.bit(other_, rotation.largest != guess.rotation.largest);
    if (other)
      rotation.largest = static_cast<std::uint8_t>(coder_.raw(rotation.largest, 2));
    else
      rotation.largest = guess.rotation.largest;
    const auto parts = parts_without(guess.rotation, rotation.largest);
    for (std::size_t i = 0; i < 3; ++i)
      rotation.parts[i] = code_small(rotation_[i], parts[i], rotation.parts[i]);
    if (!is_on_grid(rotation, form_.dimension)) good_ = false;
  }

  void code_velocities(const QuantisedBody& guess, QuantisedBody& body) {
    for (std::size_t i = 0; i < form_.dimension; ++i)
      body.velocity[i] =
          code_small(velocity_[i], body.at_rest ? 0 : guess.velocity[i], body.velocity[i]);
    if (!form_.turns) return;
    for (std::size_t i = form_.dimension == 2 ? 2 : 0; i < 3; ++i)
      body.spin[i] = code_small(spin_[i], body.at_rest ? 0 : guess.spin[i], body.spin[i]);
  }

  Coder& coder_;
  BodyForm form_;
  bool good_ = true;
  std::array<AdaptiveBit, 2> at_rest_;
  std::array<std::array<StepModel, 4>, 3> position_;  ///< By axis and how far the last one went.
  std::array<StepModel, 3> rotation_;
  std::array<StepModel, 3> velocity_;
  std::array<StepModel, 3> spin_;
  AdaptiveBit other_;
};

/// Codes what a list of bodies has become: each that the baseline has stays, changes, goes or is
/// replaced by another in its slot; then come the new ones.
template <class Coder>
class ListCoder {
 public:
  ListCoder(Coder& coder, const BodyForm& form) : coder_(coder), bodies_(coder, form) {}

  using List = std::conditional_t<Coder::kReads, std::vector<QuantisedBody>,
                                  const std::vector<QuantisedBody>>;

  /// @param now  said: the list; heard: empty, and then the list.
  /// @returns false where what is heard is no list, or one of more than `most` bodies.
  bool code(const std::vector<QuantisedBody>& base, std::size_t most, List& now) {
    std::vector<QuantisedBody> stay;
    std::vector<QuantisedBody> come;
    if constexpr (!Coder::kReads) come = new_ones(base, now);
    auto at = now.begin();
    for (const QuantisedBody& body : base) {
      while (at != now.end() && at->index < body.index) ++at;
      const bool there = at != now.end() && at->index == body.index;
      code_known(body, there ? &*at : nullptr, stay);
    }
    if (!code_new(base, most - std::min(most, stay.size()), come)) return false;
    if constexpr (Coder::kReads) return merge(stay, come, most, now);
    return true;
  }

 private:
  static bool index_is_less(const QuantisedBody& a, const QuantisedBody& b) {
    return a.index < b.index;
  }

  bool merge(const std::vector<QuantisedBody>& stay, const std::vector<QuantisedBody>& come,
             std::size_t most, std::vector<QuantisedBody>& now) const {
    if (stay.size() + come.size() > most || !bodies_.is_good()) return false;
    now.resize(stay.size() + come.size());
    std::merge(stay.begin(), stay.end(), come.begin(), come.end(), now.begin(), index_is_less);
    return std::adjacent_find(now.begin(), now.end(), [](const auto& a, const auto& b) {
             return a.index >= b.index;
           }) == now.end();
  }

  static std::vector<QuantisedBody> new_ones(const std::vector<QuantisedBody>& base,
                                             const std::vector<QuantisedBody>& now) {
    std::vector<QuantisedBody> come;
    std::set_difference(now.begin(), now.end(), base.begin(), base.end(), std::back_inserter(come),
                        index_is_less);
    return come;
  }

  /// `now` is null where the body has gone, and where it is to be heard.
  void code_known(const QuantisedBody& base, const QuantisedBody* now,
                  std::vector<QuantisedBody>& stay) {
    AdaptiveBit& model = changed_[(base.at_rest ? 2u : 0u) + (was_changed_ ? 1u : 0u)];
    was_changed_ = coder_.bit(model, now == nullptr || *now != base);
    if (!was_changed_) {
      if constexpr (Coder::kReads) stay.push_back(base);
      return;
    }
    if (coder_.bit(gone_, now == nullptr)) return;
    QuantisedBody body = now == nullptr ? base : *now;
    const bool replaced = coder_.bit(replaced_, body.generation != base.generation);
    if (replaced) code_generation(base.generation, body);
    body.index = base.index;
    bodies_.code(base, body);
    if constexpr (Coder::kReads) stay.push_back(body);
  }

  void code_generation(std::uint32_t guess, QuantisedBody& body) {
    body.generation =
        static_cast<std::uint32_t>(code_steps(coder_, generation_, static_cast<std::int32_t>(guess),
                                              static_cast<std::int32_t>(body.generation)));
  }

  /// Each is guessed from the one before it.
  bool code_new(const std::vector<QuantisedBody>& base, std::size_t most,
                std::vector<QuantisedBody>& come) {
    const auto count = static_cast<std::uint32_t>(
        code_steps(coder_, count_, 0, static_cast<std::int32_t>(come.size())));
    if (count > most) return false;
    QuantisedBody before = base.empty() ? QuantisedBody{} : base.back();
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      if constexpr (Coder::kReads) come.emplace_back() = QuantisedBody{};
      QuantisedBody& body = come[i];
      body.index = static_cast<std::uint32_t>(code_steps(
          coder_, index_, static_cast<std::int32_t>(next), static_cast<std::int32_t>(body.index)));
      code_generation(before.generation, body);
      bodies_.code(before, body);
      if (i > 0 && body.index <= before.index) return false;
      before = body;
      next = body.index + 1u;
    }
    return true;
  }

  Coder& coder_;
  BodyCoder<Coder> bodies_;
  std::array<AdaptiveBit, 4> changed_;  ///< By whether it rested, and whether the one before did.
  bool was_changed_ = false;
  AdaptiveBit gone_;
  AdaptiveBit replaced_;
  StepModel generation_;
  StepModel index_;
  StepModel count_;
};

}  // namespace cycloid::protocol
