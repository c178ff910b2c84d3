#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Balls of 1, 1000 and 100 kg over one another, the last of which comes down and slides, so that
/// each substep has something to solve. One more flies past: else all that moves would be solved at
/// once, in fewer substeps.
template <int D>
static World<D> make_column_under_a_blow(ContactBlockRows islands) {
  WorldDef<D> def = with_gravity<D>();
  def.tuning.sleep_s = 0.0f;
  def.tuning.contact_block = islands;
  World<D> world = make_world<D>(def);
  add_ground<D>(world, up<D>());
  BodyDef<D> body;
  const float heights[] = {0.5f, 1.5f, 3.5f};
  const float masses[] = {1.0f, 1000.0f, 100.0f};
  for (int i = 0; i < 3; ++i) {
    body.mass = masses[i];
    body.position[1] = heights[i];
    if (i == 2) body.velocity[0] = 0.5f;
    add(world, body, ball<D>(0.5f));
  }
  body.position[0] = 20.0f;
  body.position[1] = 100.0f;
  add(world, body, ball<D>(0.5f));
  return world;
}

/// Products of blocks in the last tick: by how much its rows are more than those of the sweeps.
template <int D>
static std::uint64_t products_of(const World<D>& world) {
  const Statistics& of = world.statistics();
  const Tuning& tuning = world.state().header.tuning;
  return of.rows - std::uint64_t{of.rows_per_sweep} * of.substeps *
                       (tuning.sweeps + tuning.relax_sweeps + tuning.position_sweeps);
}

/// Products of blocks in the tick in which the last ball comes down, and in the one behind it.
struct ProductsOfBlow {
  std::uint64_t as_it_comes = 0;
  std::uint64_t behind = 0;
};

template <int D>
static ProductsOfBlow products_of_blow(ContactBlockRows islands) {
  World<D> world = make_column_under_a_blow<D>(islands);
  step(world, 20);
  EXPECT_TRUE(world.contact_events().empty());
  for (int tick = 0; tick < 120 && world.contact_events().empty(); ++tick) step(world, 1);
  EXPECT_EQ(world.contact_events().size(), 1u);
  EXPECT_EQ(world.statistics().substeps, 4u);
  ProductsOfBlow products{products_of(world)};
  step(world, 1);
  EXPECT_TRUE(world.contact_events().empty());
  products.behind = products_of(world);
  return products;
}

template <int D>
static void expect_one_solve_as_contacts_come() {
  const ProductsOfBlow loaded = products_of_blow<D>(ContactBlockRows::kLoadedIsland);
  EXPECT_GT(loaded.as_it_comes, 0u);
  EXPECT_EQ(loaded.behind, 4 * loaded.as_it_comes) << "nothing comes any more";
  const ProductsOfBlow all = products_of_blow<D>(ContactBlockRows::kIsland);
  EXPECT_EQ(all.as_it_comes, 4 * loaded.as_it_comes) << "soft-islands leaves nothing to sweeps";
}

TEST(ChangingIslands, AreSolvedOnceInATickAndSweptInTheOtherSubsteps) {
  expect_one_solve_as_contacts_come<2>();
  expect_one_solve_as_contacts_come<3>();
}

}  // namespace cycloid::solver
