#include <gtest/gtest.h>

#include "solver/step_memory.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {
namespace {

/// Boxes in three piles of three, which stand on a floor: with their contacts in another order
/// every tick ends in other bits.
struct Piles {
  Piles() : world(make_world(with_gravity<2>())) {
    add_ground<2>(world, up<2>());
    for (int i = 0; i < 9; ++i) boxes.push_back(add_at<2>(world, place_of(i), box(0.5f, 0.5f)));
  }
  static Vec<2> place_of(int i) {
    return {{static_cast<float>(i / 3) * 1.02f + static_cast<float>(i % 3) * 0.2f,
             0.5f + static_cast<float>(i % 3)}};
  }
  void set_order(Order order) {
    Tuning tuning = world.tuning();
    tuning.order = order;
    ASSERT_TRUE(world.set_tuning(tuning).ok());
  }
  void put(std::size_t i, const Vec<2>& position) {
    ASSERT_TRUE(world.set_pose(boxes[i], position, identity_rotation<2>()).ok());
  }
  /// What a world that has never stepped comes to from here.
  std::uint64_t digest_after_a_fresh_step() const {
    World<2> fresh = make_world<2>();
    fresh.restore(world.state());
    step(fresh, 1);
    return fresh.digest();
  }

  World<2> world;
  std::vector<BodyId> boxes;
};

/// What is done to the piles before a tick.
void change(int tick, Piles& piles) {
  World<2>& world = piles.world;
  Error error;
  if (tick == 20) piles.put(8, {{20.0f, 9.0f}});     // Fewer contacts, ...
  if (tick == 25) piles.put(8, Piles::place_of(8));  // ... and as many as before.
  if (tick == 30) piles.set_order(Order::kReverse);
  if (tick == 35) piles.set_order(Order::kColor);
  if (tick == 40) error = world.destroy_body(piles.boxes[3]);
  if (tick == 40) piles.boxes[3] = add_at<2>(world, {{9.0f, 0.5f}}, box(0.5f, 0.5f));
  if (tick == 45) error = world.set_mass(piles.boxes[4], 40.0f);
  if (tick == 50) piles.set_order(Order::kId);
  for (std::size_t i = 0; tick == 55 && i < piles.boxes.size(); ++i)  // No contact at all.
    piles.put(i, {{10.0f * static_cast<float>(i), 1.5f}});
  if (tick == 56) piles.set_order(Order::kColor);
  EXPECT_TRUE(error.ok()) << error.field;
}

TEST(ContactColors, AreThoseOfAFreshWorldWhateverHasChanged) {
  Piles piles;
  for (int tick = 0; tick < 120; ++tick) {
    change(tick, piles);
    const std::uint64_t fresh = piles.digest_after_a_fresh_step();
    step(piles.world, 1);
    ASSERT_EQ(piles.world.digest(), fresh) << "tick " << tick;
  }
}

TEST(ContactColors, OfWorldsThatStepInTheSameMemoryAreTheirOwn) {
  const auto memory = make_step_memory<2>();
  Piles colored;
  Piles reversed;
  Piles apart;
  reversed.set_order(Order::kReverse);
  for (std::size_t i = 0; i < apart.boxes.size(); ++i)
    apart.put(i, {{10.0f * static_cast<float>(i), 40.0f}});
  for (Piles* piles : {&colored, &reversed, &apart}) piles->world.use_step_memory(memory);
  for (int tick = 0; tick < 40; ++tick)
    for (Piles* piles : {&colored, &reversed, &colored, &apart, &colored, &colored}) {
      const std::uint64_t fresh = piles->digest_after_a_fresh_step();
      step(piles->world, 1);
      ASSERT_EQ(piles->world.digest(), fresh) << "tick " << tick;
    }
}

}  // namespace
}  // namespace cycloid::solver
