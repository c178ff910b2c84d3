#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "solver/constraints/contact_normals.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Where a manifold of a box lies under its centre, and how the box moves there.
struct Load {
  double half_x = 0.5;
  double half_z = 0.5;
  double drop = 0.5;  ///< Of the manifold below the centre of mass, m.
  double mass = 1.0;
  double speed = -1.0;  ///< Of the centre, upwards, m/s.
  double spin_x = 0.0;  ///< rad/s
  double spin_z = 0.0;
  std::array<std::array<double, 2>, 4> at = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};  ///< Of half.
};

/// J of each row over (height, turn about x, turn about z), and the inverse masses.
struct Rows {
  double j[4][3];
  double inverse[3];
  double d[4];
};

static Rows rows_of(const Load& load) {
  Rows rows{};
  const double height = 2.0 * load.drop;
  const auto moment = [&](double half) {
    return load.mass / 12.0 * (4.0 * half * half + height * height);
  };
  rows.inverse[0] = 1.0 / load.mass;
  rows.inverse[1] = 1.0 / moment(load.half_z);
  rows.inverse[2] = 1.0 / moment(load.half_x);
  for (std::size_t i = 0; i < 4; ++i) {
    rows.j[i][0] = 1.0;
    rows.j[i][1] = -load.at[i][1] * load.half_z;
    rows.j[i][2] = load.at[i][0] * load.half_x;
    rows.d[i] = load.speed + rows.j[i][1] * load.spin_x + rows.j[i][2] * load.spin_z;
  }
  return rows;
}

template <int W>
static void set_lane_of(Lanes<W>& lanes, int lane, double value) {
  float values[W];
  lanes.store(values);
  values[lane] = static_cast<float>(value);
  lanes = Lanes<W>::load(values);
}

struct Solution {
  std::array<double, 4> x{};
  bool usable = false;
  double wrench_error = 0.0;  ///< Of velocities after, over those before, in the energy norm.
};

/// Impulses of every load, each in a lane of its own.
template <int W>
static std::vector<Solution> solve_all(const std::vector<Load>& loads) {
  std::vector<Solution> solutions;
  for (std::size_t begin = 0; begin < loads.size(); begin += W) {
    NormalProblem<4, Lanes<W>> problem;
    for (auto& row : problem.k)
      for (auto& value : row) value = Lanes<W>(0.0f);
    for (auto& value : problem.d) value = Lanes<W>(0.0f);
    const std::size_t end = std::min(loads.size(), begin + W);
    for (std::size_t l = begin; l < end; ++l) {
      const Rows rows = rows_of(loads[l]);
      const int lane = static_cast<int>(l - begin);
      for (int i = 0; i < 4; ++i) {
        set_lane_of(problem.d[i], lane, rows.d[i]);
        for (int j = 0; j < 4; ++j) {
          double k = 0.0;
          for (int f = 0; f < 3; ++f) k += rows.j[i][f] * rows.inverse[f] * rows.j[j][f];
          set_lane_of(problem.k[i][j], lane, k);
        }
      }
    }
    Lanes<W> x[4];
    Lanes<W> usable;
    solve_normals(problem, 4, x, usable);
    for (std::size_t l = begin; l < end; ++l) {
      const auto lane = static_cast<std::size_t>(l - begin);
      float values[W];
      Solution solution;
      for (std::size_t i = 0; i < 4; ++i) {
        x[i].store(values);
        solution.x[i] = double{values[lane]};
      }
      usable.store(values);
      solution.usable = values[lane] > 0.0f;
      solutions.push_back(solution);
    }
  }
  return solutions;
}

/// max |min(x, w / K_ii)| over max |d| / K_ii, in double.
static double relative_residual(const Load& load, const std::array<double, 4>& x) {
  const Rows rows = rows_of(load);
  double worst = 0.0;
  double scale = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    double w = rows.d[i];
    double diagonal = 0.0;
    for (std::size_t f = 0; f < 3; ++f) {
      double velocity = 0.0;
      for (std::size_t j = 0; j < 4; ++j) velocity += rows.inverse[f] * rows.j[j][f] * x[j];
      w += rows.j[i][f] * velocity;
      diagonal += rows.j[i][f] * rows.inverse[f] * rows.j[i][f];
    }
    worst = std::max(worst, std::abs(std::min(x[i], w / diagonal)));
    scale = std::max(scale, std::abs(rows.d[i]) / diagonal);
  }
  return worst / scale;
}

/// Boxes and motions of all kinds, the same every time.
static std::vector<Load> many_loads() {
  std::vector<Load> loads;
  std::uint32_t seed = 1;
  const auto random = [&](double lower, double upper) {
    seed = seed * 1664525u + 1013904223u;
    return lower + (upper - lower) * (seed >> 8) / 16777216.0;
  };
  for (int i = 0; i < 2000; ++i) {
    Load load;
    load.half_x = std::pow(10.0, random(-1.0, 1.0));
    load.half_z = std::pow(10.0, random(-1.0, 1.0));
    load.drop = std::pow(10.0, random(-1.0, 1.0));
    load.mass = std::pow(10.0, random(-3.0, 3.0));
    load.speed = random(-1.0, 0.3);
    load.spin_x = random(-1.0, 1.0) / load.half_z;
    load.spin_z = random(-1.0, 1.0) / load.half_x;
    for (auto& at : load.at)
      if (i % 4 == 3) at = {random(-1.0, 1.0), random(-1.0, 1.0)};
    if (i % 8 == 7) load.at[3] = load.at[1];
    loads.push_back(load);
  }
  return loads;
}

TEST(NormalBlock, SolvesBoxesOfAllShapesToTheResidualItAsksFor) {
  const std::vector<Load> loads = many_loads();
  const std::vector<Solution> solutions = solve_all<8>(loads);
  std::size_t usable = 0;
  double worst = 0.0;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    for (const double x : solutions[i].x) ASSERT_TRUE(std::isfinite(x) && x >= 0.0) << i;
    if (!solutions[i].usable) continue;
    ++usable;
    worst = std::max(worst, relative_residual(loads[i], solutions[i].x));
  }
  EXPECT_EQ(usable, loads.size());
  EXPECT_LT(worst, 1.0e-6);
}

TEST(NormalBlock, GivesTheSameBitsInEveryWidth) {
  const std::vector<Load> loads = many_loads();
  const std::vector<Solution> narrow = solve_all<1>(loads);
  const std::vector<Solution> wide = solve_all<16>(loads);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    EXPECT_EQ(narrow[i].usable, wide[i].usable) << i;
    EXPECT_EQ(narrow[i].x, wide[i].x) << i;
  }
}

// A box that falls flat on its four corners: of all impulses that stop it, a quarter each.
TEST(NormalBlock, SharesACentredLoadEvenly) {
  const Solution flat = solve_all<1>({Load{}})[0];
  ASSERT_TRUE(flat.usable);
  for (const double x : flat.x) EXPECT_NEAR(x, 0.25, 1.0e-3);
}

TEST(NormalBlock, StaysFiniteForDuplicateAndNearlyEqualPoints) {
  std::vector<Load> loads;
  for (const double apart : {0.0, 1.0e-7, 1.0e-4, 1.0e-3})
    for (const double spin : {0.0, 0.5, 30.0})
      for (const double mass : {1.0e-4, 1.0, 1.0e4}) {
        Load load;
        load.half_x = load.half_z = 0.5;
        load.mass = mass;
        load.spin_z = spin;
        load.at = {
            {{1.0, 1.0}, {1.0 - apart, 1.0}, {1.0, 1.0 - apart}, {1.0 - apart, 1.0 - apart}}};
        loads.push_back(load);
        load.at = {{{-1.0, 0.0}, {-1.0 + apart, 0.0}, {1.0, 0.0}, {1.0 - apart, 0.0}}};
        loads.push_back(load);
      }
  const std::vector<Solution> solutions = solve_all<4>(loads);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    for (const double x : solutions[i].x) ASSERT_TRUE(std::isfinite(x) && x >= 0.0) << i;
    if (solutions[i].usable) {
      EXPECT_LT(relative_residual(loads[i], solutions[i].x), 2.0e-5) << i;
    }
  }
}

// No x >= 0 brings both w to 0 or above: the rows must be left to be solved one after the other.
TEST(NormalBlock, SaysWhereItHasNoSolution) {
  NormalProblem<4, Lanes<4>> problem;
  for (auto& row : problem.k)
    for (auto& value : row) value = Lanes<4>(0.0f);
  for (int i = 0; i < 4; ++i) {
    problem.k[i][i] = Lanes<4>(1.0f);
    problem.d[i] = Lanes<4>(-1.0f);
  }
  set_lane_of(problem.k[0][1], 2, -2.0);
  set_lane_of(problem.k[1][0], 2, -2.0);
  Lanes<4> x[4];
  Lanes<4> usable;
  solve_normals(problem, 4, x, usable);
  float values[4];
  usable.store(values);
  for (int lane = 0; lane < 4; ++lane) EXPECT_EQ(values[lane], lane == 2 ? 0.0f : 1.0f) << lane;
}

/// A cube on a plane after one tick of one sweep from nothing, over what the tick of fall gives.
struct Rest {
  float carried;  ///< Sum of the normal impulses over the weight's.
  float speed;    ///< What is left of the fall, over it.
  float spin;     ///< The same at a corner's distance.
};

/// @param load  kg of a ball in the cube of 1 kg, off its middle.
static Rest rest_after_one_tick(ContactBlockRows together, float load, std::uint32_t sweeps = 1) {
  WorldDef<3> def = with_gravity<3>({0.0f, 0.0f});
  def.tuning = Tuning::pgs();
  def.tuning.sweeps = sweeps;
  def.tuning.warm_starting = 0.0f;
  def.tuning.contact_block = together;
  World<3> world = make_world(def);
  add_ground<3>(world, up<3>());
  std::vector<ShapeDef<3>> shapes(1);
  shapes[0].kind = ShapeKind::kBox;
  shapes[0].half = {{0.5f, 0.5f, 0.5f}};
  if (load > 0.0f) {
    ShapeDef<3> ballast = ball<3>(0.2f);
    ballast.points = {{{0.2f, 0.1f, -0.15f}}};
    ballast.density = load / (4.0f / 3.0f * 3.14159265f * 0.008f);
    shapes.push_back(ballast);
  }
  BodyDef<3> body;
  body.position = {{0.0f, 0.5f, 0.0f}};
  const Result<BodyId> id = world.create_body(body, shapes);
  EXPECT_TRUE(id.ok());
  step(world, 1);
  EXPECT_EQ(world.state().contacts.size(), 1u);
  const Contact<3>& contact = world.state().contacts[0];
  EXPECT_EQ(contact.point_count, 4u);
  float sum = 0.0f;
  for (const ContactPoint<3>& point : contact.points) sum += point.normal_impulse;
  const float fall = 10.0f * kTick;
  const BodyView<3> now = view(world, id.value());
  return {sum / ((1.0f + load) * fall), now.velocity[1] / fall, 0.7f * length(now.spin) / fall};
}

TEST(NormalBlock, RestsACubeInOneSweepWhereRowByRowDoesNot) {
  for (const float load : {0.0f, 1.0f, 20.0f}) {
    const Rest together = rest_after_one_tick(ContactBlockRows::kNormals, load);
    EXPECT_NEAR(together.carried, 1.0f, 1.0e-4f) << load;
    EXPECT_NEAR(together.speed, 0.0f, 1.0e-4f) << load;
    EXPECT_NEAR(together.spin, 0.0f, 1.0e-4f) << load;
    const Rest apart = rest_after_one_tick(ContactBlockRows::kNone, load);
    EXPECT_GT(std::abs(apart.speed) + apart.spin, 0.01f) << load;
  }
}

// Every setting that has blocks, warm starting, soft rows and positions: a cube set down flat
// stays where it is, and one on its edge falls over and comes to rest.
TEST(NormalBlock, BringsCubesToRestUnderEverySetting) {
  for (Tuning tuning : {Tuning::soft_step(), Tuning::pgs(), Tuning::split_impulse(),
                        Tuning::pgs_ngs_block(), Tuning::tgs_ngs(), Tuning::pgs_soft()}) {
    tuning.contact_block = ContactBlockRows::kNormals;
    tuning.sleep_s = 0.0f;
    WorldDef<3> def = with_gravity<3>({0.6f, 0.0f});
    def.tuning = tuning;
    World<3> world = make_world(def);
    add_ground<3>(world, up<3>());
    ShapeDef<3> cube;
    cube.kind = ShapeKind::kBox;
    cube.half = {{0.5f, 0.5f, 0.5f}};
    const BodyId flat = add_at<3>(world, {{0.0f, 0.5f, 0.0f}}, cube);
    BodyDef<3> tilted;
    tilted.position = {{5.0f, 0.9f, 0.0f}};
    tilted.rotation = {{0.2f, 0.1f, 0.15f, std::sqrt(1.0f - 0.0725f)}};
    const BodyId fallen = add(world, tilted, cube);
    step(world, 300);
    for (const BodyId id : {flat, fallen}) {
      const BodyView<3> now = view(world, id);
      EXPECT_LT(length(now.velocity), 2.0e-3f);
      EXPECT_LT(length(now.spin), 2.0e-3f);
      EXPECT_NEAR(now.position[1], 0.5f, 0.01f);
    }
    EXPECT_NEAR(length(view(world, flat).position - Vec<3>{{0.0f, 0.5f, 0.0f}}), 0.0f, 8.0e-3f);
  }
}

// Boxes, capsules and balls share their blocks with other point counts as the width changes.
TEST(NormalBlock, GivesAWorldTheSameBitsInEveryWidth) {
  for (Tuning tuning : {Tuning::soft_step(), Tuning::pgs_ngs_block()}) {
    tuning.contact_block = ContactBlockRows::kNormals;
    std::vector<std::uint64_t> digests;
    for (const int lanes : {1, 4, 8, 16}) {
      WorldDef<3> def = with_gravity<3>({0.4f, 0.0f, 0.05f, 0.05f});
      def.tuning = tuning;
      World<3> world = make_world(def);
      ASSERT_TRUE(world.set_lanes(lanes).ok());
      add_ground<3>(world, up<3>());
      for (int i = 0; i < 30; ++i) {
        ShapeDef<3> shape = ball<3>(0.4f);
        if (i % 3 == 0) {
          shape.kind = ShapeKind::kBox;
          shape.half = {{0.3f, 0.5f, 0.4f}};
          shape.radius = 0.0f;
        } else if (i % 3 == 1) {
          shape.kind = ShapeKind::kCapsule;
          shape.points = {{{-0.4f, 0.0f, 0.0f}}, {{0.4f, 0.0f, 0.0f}}};
        }
        BodyDef<3> body;
        const auto at = static_cast<float>(i);
        body.position = {{2.5f * at, 0.8f + 0.02f * at, 0.0f}};
        body.spin = {{0.3f, 0.1f * at, 0.2f}};
        add(world, body, shape);
      }
      step(world, 120);
      digests.push_back(world.digest());
    }
    for (const std::uint64_t digest : digests) EXPECT_EQ(digest, digests[0]);
  }
}

}  // namespace cycloid::solver
