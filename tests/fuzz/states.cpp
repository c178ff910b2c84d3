#include <algorithm>
#include <cmath>

#include "protocol/state/exact_delta.hpp"
#include "protocol/state/quantised_delta.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/hostile/matches.hpp"

namespace cycloid::fuzz {

static constexpr std::size_t kStateBytesMax = 1u << 16;
static constexpr std::size_t kStateBodiesMax = 256;

/// Two states of one scene, some ticks apart, in both profiles.
struct GoodStates {
  Seed exact_before;
  Seed exact_now;
  protocol::QuantisedState before;
  protocol::QuantisedState now;
};

static GoodStates played_states(const std::string& name) {
  const scenes::Scene scene = hostile::catalogue_scene(name);
  scenes::Simulation simulation = std::move(scenes::Simulation::create(scene).value());
  auto step = [&] {
    std::vector<scenes::SeatInput> inputs;
    for (int seat = 0; seat < simulation.seats(); ++seat)
      inputs.push_back(scenes::scripted_input(scene, seat, simulation.tick() + 1));
    if (!simulation.step(inputs).ok()) fail("a step fails");
  };
  GoodStates good;
  for (int tick = 0; tick < 40; ++tick) step();
  simulation.encode(good.exact_before);
  good.before = protocol::capture(simulation);
  for (int tick = 0; tick < 4; ++tick) step();
  simulation.encode(good.exact_now);
  good.now = protocol::capture(simulation);
  return good;
}

static const std::vector<GoodStates>& good_states() {
  static const std::vector<GoodStates> kGood = {played_states("stack-10"),
                                                played_states("character-course-3d")};
  return kGood;
}

static Seed exact_delta(const GoodStates& good, bool from_nothing) {
  Seed delta;
  if (!protocol::encode_exact_delta(from_nothing ? Seed{} : good.exact_before, good.exact_now,
                                    delta))
    fail("an encoding is not taken for one");
  return delta;
}

static Seed quantised_delta(const GoodStates& good, bool from_nothing) {
  const protocol::HeldState held{good.before, {}};
  return protocol::encode_quantised(from_nothing ? nullptr : &held, good.now, kStateBytesMax).bytes;
}

static void run_exact(const GoodStates& good, bool from_nothing, const Seed& bytes) {
  const Seed baseline = from_nothing ? Seed{} : good.exact_before;
  const auto read = protocol::decode_exact_delta(baseline, bytes, kStateBytesMax);
  if (!read) return;
  if (read->size() > kStateBytesMax) fail("more bytes than allowed");
  Seed again;
  if (!protocol::encode_exact_delta(baseline, *read, again)) fail("what was read is no encoding");
  if (protocol::decode_exact_delta(baseline, again, kStateBytesMax) != read)
    fail("what was read cannot be said again");
}

static void expect_showable(const protocol::QuantisedState& state) {
  for (const auto* list : {&state.bodies, &state.particles}) {
    if (list->size() > kStateBodiesMax) fail("more bodies than allowed");
    for (const protocol::QuantisedBody& body : *list) {
      if (&body != list->data() && body.index <= (&body - 1)->index) fail("bodies out of order");
      const scenes::Pose pose = protocol::pose_of(body, state.dimension);
      float square = 0.0f;
      for (const float part : pose.rotation) square += part * part;
      if (!(std::abs(square - 1.0f) < 1e-4f)) fail("a rotation that is none");
    }
  }
}

static void run_quantised(const GoodStates& good, bool from_nothing, const Seed& bytes) {
  const protocol::QuantisedState* baseline = from_nothing ? nullptr : &good.before;
  const auto read = protocol::decode_quantised(baseline, 44, bytes, kStateBodiesMax);
  if (!read) return;
  expect_showable(*read);
  const protocol::HeldState held{good.before, {}};
  const protocol::QuantisedDelta again =
      protocol::encode_quantised(from_nothing ? nullptr : &held, *read, kStateBytesMax);
  if (!again.held.waiting.empty()) return;
  if (protocol::decode_quantised(baseline, 44, again.bytes, kStateBodiesMax) != read)
    fail("what was read cannot be said again");
}

void run_state_delta(Input input) {
  const unsigned mode = mode_of(input);
  const GoodStates& good = good_states()[mode / 8 % good_states().size()];
  const bool exact = mode / 2 % 2 == 0;
  const bool from_nothing = mode / 4 % 2 == 1;
  Seed bytes(input.begin(), input.end());
  if (mode % 2 == kEditMode)
    bytes = edited(exact ? exact_delta(good, from_nothing) : quantised_delta(good, from_nothing),
                   input);
  if (exact)
    run_exact(good, from_nothing, bytes);
  else
    run_quantised(good, from_nothing, bytes);
}

std::vector<Seed> state_delta_seeds() {
  std::vector<Seed> seeds;
  for (unsigned i = 0; i < good_states().size(); ++i)
    for (const bool from_nothing : {false, true}) {
      const unsigned mode = 8 * i + (from_nothing ? 4 : 0);
      seeds.push_back(with_mode(mode, exact_delta(good_states()[i], from_nothing)));
      seeds.push_back(with_mode(mode + 2, quantised_delta(good_states()[i], from_nothing)));
      seeds.push_back(with_mode(mode + kEditMode, Seed(16, std::byte{1})));
      seeds.push_back(with_mode(mode + 2 + kEditMode, Seed(16, std::byte{1})));
    }
  return seeds;
}

}  // namespace cycloid::fuzz
