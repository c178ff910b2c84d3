#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// What there is beside the column.
struct Beside {
  bool flies = true;   ///< A ball that flies past: else all that moves would be solved at once.
  bool hangs = false;  ///< A ball on a rod to the heaviest, so that its island has a joint.
};

/// Balls of 1, 1000 and 100 kg over one another, the last of which comes down and slides, so that
/// each substep has something to solve.
template <int D>
static World<D> make_column_under_a_blow(ContactBlockRows islands, const Beside& beside) {
  WorldDef<D> def = with_gravity<D>();
  def.tuning.sleep_s = 0.0f;
  def.tuning.contact_block = islands;
  World<D> world = make_world<D>(def);
  add_ground<D>(world, up<D>());
  BodyDef<D> body;
  const float heights[] = {0.5f, 1.5f, 3.5f};
  const float masses[] = {1.0f, 1000.0f, 100.0f};
  BodyId balls[3];
  for (int i = 0; i < 3; ++i) {
    body.mass = masses[i];
    body.position[1] = heights[i];
    if (i == 2) body.velocity[0] = 0.5f;
    balls[i] = add(world, body, ball<D>(0.5f));
  }
  if (beside.hangs) {
    body.position = at<D>(2.0f, 1.5f);
    JointDef<D> rod;
    rod.kind = JointKind::kDistance;
    rod.body_a = balls[1];
    rod.body_b = add(world, body, ball<D>(0.5f));
    rod.length = 2.0f;
    EXPECT_TRUE(world.create_joint(rod).ok());
  }
  if (beside.flies) {
    body.position = at<D>(20.0f, 100.0f);
    add(world, body, ball<D>(0.5f));
  }
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

/// The column in the tick in which its last ball comes down.
template <int D>
static World<D> column_as_it_comes(ContactBlockRows islands, const Beside& beside = {}) {
  World<D> world = make_column_under_a_blow<D>(islands, beside);
  step(world, 20);
  EXPECT_TRUE(world.contact_events().empty());
  for (int tick = 0; tick < 120 && world.contact_events().empty(); ++tick) step(world, 1);
  EXPECT_EQ(world.contact_events().size(), 1u);
  return world;
}

/// Products of the tick behind. @pre in that one nothing comes or goes.
template <int D>
static std::uint64_t products_behind(World<D>& world) {
  step(world, 1);
  EXPECT_TRUE(world.contact_events().empty());
  return products_of(world);
}

template <int D>
static void expect_one_solve_as_contacts_come() {
  World<D> loaded = column_as_it_comes<D>(ContactBlockRows::kLoadedIsland);
  const World<D> all = column_as_it_comes<D>(ContactBlockRows::kIsland);
  const std::uint64_t as_it_comes = products_of(loaded);
  EXPECT_EQ(loaded.statistics().substeps, 4u);
  EXPECT_GT(as_it_comes, 0u);
  EXPECT_EQ(products_of(all), 4 * as_it_comes) << "soft-islands leaves nothing to sweeps";
  EXPECT_EQ(products_behind(loaded), 4 * as_it_comes) << "nothing comes any more";
}

TEST(ChangingIslands, AreSolvedOnceInATickAndSweptInTheOtherSubsteps) {
  expect_one_solve_as_contacts_come<2>();
  expect_one_solve_as_contacts_come<3>();
}

template <int D>
static void expect_all_solves_with_a_joint() {
  const Beside beside{.flies = true, .hangs = true};
  const World<D> loaded = column_as_it_comes<D>(ContactBlockRows::kLoadedIsland, beside);
  const World<D> all = column_as_it_comes<D>(ContactBlockRows::kIsland, beside);
  EXPECT_EQ(loaded.statistics().substeps, 4u);
  EXPECT_GT(products_of(loaded), 0u);
  EXPECT_EQ(products_of(loaded), products_of(all));
}

TEST(ChangingIslands, WithAJointAreSolvedInEverySubstep) {
  expect_all_solves_with_a_joint<2>();
  expect_all_solves_with_a_joint<3>();
}

template <int D>
static void expect_all_solves_where_all_is_one_island() {
  World<D> world = column_as_it_comes<D>(ContactBlockRows::kLoadedIsland, {.flies = false});
  const std::uint64_t as_it_comes = products_of(world);
  EXPECT_EQ(world.statistics().substeps, 2u);
  EXPECT_GT(as_it_comes, 0u);
  EXPECT_EQ(products_behind(world), as_it_comes);
}

TEST(ChangingIslands, AreSolvedInEverySubstepWhereTheyHaveAllThatMoves) {
  expect_all_solves_where_all_is_one_island<2>();
  expect_all_solves_where_all_is_one_island<3>();
}

}  // namespace cycloid::solver
