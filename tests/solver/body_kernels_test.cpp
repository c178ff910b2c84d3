#include "solver/bodies/body_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "solver/bodies/passing.hpp"
#include "solver/collision/pair_cache.hpp"
#include "solver/shapes.hpp"
#include "tests/solver/every_width.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static float drawn(std::mt19937& random, float most) {
  return std::uniform_real_distribution<float>(-most, most)(random);
}

/// Every third does not turn, and some turn far.
static Motion<2> drawn_motion(std::mt19937& random) {
  const float angle = drawn(random, 3.0f);
  const float spin = random() % 3 == 0 ? 0.0f : drawn(random, random() % 4 == 0 ? 900.0f : 5.0f);
  return {{{drawn(random, 50.0f), drawn(random, 50.0f)}},
          {{spin}},
          {{drawn(random, 1.0f), drawn(random, 1.0f)}},
          rotation_by(Spin<2>{{angle}})};
}

template <int W>
static void expect_to_move_as_one(const std::vector<Motion<2>>& motions,
                                  const std::vector<std::uint32_t>& bodies) {
  constexpr float kStep = 1.0f / 240.0f;
  std::vector<Motion<2>> expected = motions;
  for (const std::uint32_t body : bodies) {
    expected[body].delta_position += kStep * expected[body].velocity;
    turn_by(kStep * expected[body].spin, expected[body]);
  }
  std::vector<Motion<2>> moved = motions;
  BodyKernels<W>::move(kStep, bodies.data(), static_cast<int>(bodies.size()), moved.data());
  for (std::size_t i = 0; i < moved.size(); ++i)
    EXPECT_EQ(std::memcmp(&expected[i], &moved[i], sizeof(float) * kMotionComponents<2>), 0)
        << "body " << i << " of " << bodies.size() << ", width " << W;
}

/// Of a body that something may slow down, or drive; of every fifth of one without mass.
static Acceleration<2> drawn_acceleration(std::mt19937& random) {
  Acceleration<2> of{{1.0f, 1.0f, 1.0f, 1.0f}, {-0.0f, -0.0f, -0.0f, -0.0f}};
  if (random() % 5 == 0) return of;
  const float slows = random() % 2 == 0 ? 0.0f : 1.0f;
  for (int i = 0; i < 3; ++i) {
    of.factor[i] = 1.0f - slows * std::abs(drawn(random, 0.1f));
    if (i < 2 || random() % 2 == 0) of.rate[i] = drawn(random, 30.0f);
  }
  return of;
}

/// Substep after substep, as the stages have it.
static void fly_alone(float h, int substeps, const Acceleration<2>& of, Motion<2>& motion) {
  for (int substep = 0; substep < substeps; ++substep) {
    for (int i = 0; i < 2; ++i)
      motion.velocity[i] = of.factor[i] * (motion.velocity[i] + h * of.rate[i]);
    motion.spin[0] = of.factor[2] * (motion.spin[0] + h * of.rate[2]);
    motion.delta_position += h * motion.velocity;
    turn_by(h * motion.spin, motion);
  }
}

template <int W>
static void expect_to_fly_as_one(const std::vector<Motion<2>>& motions,
                                 const std::vector<std::uint32_t>& bodies,
                                 const std::vector<Acceleration<2>>& accelerations) {
  constexpr float kStep = 1.0f / 240.0f;
  for (const int substeps : {1, 2, 4, 7}) {
    std::vector<Motion<2>> expected = motions;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      fly_alone(kStep, substeps, accelerations[i], expected[bodies[i]]);
    std::vector<Motion<2>> flown = motions;
    BodyKernels<W>::fly(kStep, substeps, accelerations.data(), bodies.data(),
                        static_cast<int>(bodies.size()), flown.data());
    for (std::size_t i = 0; i < flown.size(); ++i)
      EXPECT_EQ(std::memcmp(&expected[i], &flown[i], sizeof(float) * kMotionComponents<2>), 0)
          << "body " << i << " of " << bodies.size() << ", width " << W;
  }
}

/// A ball, capsule, triangle or polygon of four corners.
static ShapeDef<2> drawn_shape(std::mt19937& random) {
  ShapeDef<2> shape = box(1.0f + 0.5f * drawn(random, 1.0f), 1.0f + 0.5f * drawn(random, 1.0f));
  switch (random() % 4) {
    case 0:
      return ball<2>(0.5f + 0.25f * drawn(random, 1.0f));
    case 1:
      return capsule(1.0f + 0.5f * drawn(random, 1.0f), 0.25f);
    case 2:
      shape.points = {{{-1.0f, -1.0f}}, {{1.0f, -1.0f}}, {{drawn(random, 1.0f), 1.0f}}};
      break;
    default:
      break;
  }
  if (random() % 2 == 0) shape.radius = 0.1f;
  return shape;
}

struct Flock {
  std::vector<Shape<2>> shapes;
  std::vector<std::uint32_t> numbers;
  std::vector<FlyingShape> flying;
  std::vector<Bounds<2>> boxes;  ///< By shape: one by one.
};

static Flock drawn_flock(std::mt19937& random, std::uint32_t count) {
  constexpr float kMargin = 0.02f;
  Flock flock;
  for (std::uint32_t i = 0; i < 2 * count; ++i)
    EXPECT_TRUE(append_shapes(drawn_shape(random), 0, flock.shapes).ok());
  flock.boxes.resize(flock.shapes.size());
  for (std::uint32_t i = 0; i < 2 * count; i += 2) {  // Every second shape lies still.
    const Shape<2>& shape = flock.shapes[i];
    const float angle = drawn(random, 3.0f);
    const Pose<2> pose{{{drawn(random, 9.0f), drawn(random, 9.0f)}}, rotation_by(Spin<2>{{angle}})};
    const Vec<2> flight = {{drawn(random, 1.0f), drawn(random, 1.0f)}};
    flock.numbers.push_back(i);
    flock.flying.push_back(
        {pose, flight, shape.radius + kMargin, static_cast<float>(shape.vertex_count - 1)});
    flock.boxes[i] = along(bounds_of(shape, pose, kMargin), flight);
  }
  return flock;
}

template <int W>
static void expect_boxes_as_of_one(const Flock& flock) {
  std::vector<Bounds<2>> boxes(flock.shapes.size());
  BodyKernels<W>::find_boxes(flock.flying.data(), flock.numbers.data(),
                             static_cast<int>(flock.numbers.size()), flock.shapes.data(),
                             boxes.data());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_EQ(flock.boxes[i].lower[axis], boxes[i].lower[axis]) << i << ", width " << W;
      EXPECT_EQ(flock.boxes[i].upper[axis], boxes[i].upper[axis]) << i << ", width " << W;
    }
}

struct MovedBodies {
  std::vector<Body<2>> bodies;
  std::vector<Motion<2>> motions;
  std::vector<double> ways;  ///< Of the farthest corner, m; of what is no number, very far.
  std::vector<std::uint32_t> slots;
};

/// With whole turns, and without a function of libm, which is another on each platform: the root of
/// doubles is exact.
static double way_in_a_tick(double tick_s, const Body<2>& body, const Motion<2>& motion,
                            double angle) {
  const double x = motion.delta_position[0];
  const double y = motion.delta_position[1];
  const double flown = std::sqrt(x * x + y * y);
  const double spun = std::abs(tick_s * motion.spin[0]);
  const double turned = std::max(spun > 3.0 ? spun : 0.0, std::abs(angle));
  return std::isnan(flown) ? 1.0e9 : flown + body.extent * turned;
}

/// Bodies that move by about as much as their thickness allows; one in eight of no number.
static MovedBodies drawn_moved(std::mt19937& random, std::uint32_t count) {
  MovedBodies moved;
  for (std::uint32_t i = 0; i < 2 * count; ++i) {
    Body<2> body{};
    body.extent = 1.5f + drawn(random, 1.0f);
    body.thickness = 0.5f + drawn(random, 0.5f);
    moved.bodies.push_back(body);
    const float angle = random() % 4 == 0 ? drawn(random, 3.1f) : drawn(random, 0.1f);
    const float spin = random() % 4 == 0 ? drawn(random, 400.0f) : 60.0f * angle;
    Motion<2> motion{{{0.0f, 0.0f}},
                     {{spin}},
                     {{drawn(random, 0.3f), drawn(random, 0.3f)}},
                     rotation_by(Spin<2>{{angle}})};
    if (random() % 8 == 0) motion.delta_position[random() % 2] = std::nanf("");
    moved.motions.push_back(motion);
    moved.ways.push_back(way_in_a_tick(1.0 / 60.0, body, motion, angle));
    if (i % 2 == 1) moved.slots.push_back(i);
  }
  return moved;
}

template <int W>
static std::uint64_t moved_far(const MovedBodies& moved) {
  return BodyKernels<W>::moved_far(1.0f / 60.0f, moved.bodies.data(), moved.slots.data(),
                                   static_cast<int>(moved.slots.size()), moved.motions.data());
}

TEST(BodyKernels, MoveAnyNumberOfBodiesAsOneByOneAtEveryWidth) {
  std::mt19937 random(20261125);
  for (std::uint32_t count = 1; count <= 70; ++count) {
    std::vector<Motion<2>> motions;
    std::vector<std::uint32_t> bodies;
    for (std::uint32_t i = 0; i < count; ++i) {
      motions.push_back(drawn_motion(random));
      motions.push_back(drawn_motion(random));  // Every second one is asleep.
      bodies.push_back(2 * i + 1);
    }
    for_each_width<1, 4>([&]<int W>() { expect_to_move_as_one<W>(motions, bodies); });
    ASSERT_FALSE(HasFailure());
  }
}

TEST(BodyKernels, FlyAnyNumberOfBodiesAsOneByOneAtEveryWidth) {
  std::mt19937 random(20261128);
  for (std::uint32_t count = 1; count <= 70; ++count) {
    std::vector<Motion<2>> motions;
    std::vector<std::uint32_t> bodies;
    std::vector<Acceleration<2>> accelerations;
    for (std::uint32_t i = 0; i < count; ++i) {
      motions.push_back(drawn_motion(random));
      motions.push_back(drawn_motion(random));  // Every second one is held by something.
      bodies.push_back(2 * (count - i) - 1);
      accelerations.push_back(drawn_acceleration(random));
    }
    for_each_width<1, 4>([&]<int W>() { expect_to_fly_as_one<W>(motions, bodies, accelerations); });
    ASSERT_FALSE(HasFailure());
  }
}

TEST(BodyKernels, FindTheBoxesOfOneByOneAtEveryWidth) {
  std::mt19937 random(20261126);
  for (std::uint32_t count = 1; count <= 70; ++count) {
    const Flock flock = drawn_flock(random, count);
    for_each_width<1, 4>([&]<int W>() { expect_boxes_as_of_one<W>(flock); });
    ASSERT_FALSE(HasFailure());
  }
}

TEST(BodyKernels, FindWhoMayHaveMovedByHalfItsThicknessAtEveryWidth) {
  std::mt19937 random(20261127);
  int far_count = 0;
  int near_count = 0;
  for (std::uint32_t round = 0; round < 640; ++round) {
    const MovedBodies moved = drawn_moved(random, 1 + round % 64);
    const std::uint64_t far = moved_far<1>(moved);
    for_each_width<1, 4>([&]<int W>() { EXPECT_EQ(far, moved_far<W>(moved)) << "width " << W; });
    for (std::size_t i = 0; i < moved.slots.size(); ++i) {
      const Body<2>& body = moved.bodies[moved.slots[i]];
      const double way = moved.ways[moved.slots[i]];
      const bool is_far = (far >> i & 1u) != 0;
      EXPECT_TRUE(is_far || way <= 0.5 * body.thickness) << way << " of " << body.thickness;
      EXPECT_TRUE(!is_far || way >= 0.2 * body.thickness) << way << " of " << body.thickness;
      ++(is_far ? far_count : near_count);
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(far_count, 2000);
  EXPECT_GT(near_count, 2000);
}

/// Bodies of which half do not yield, and some turn too far to tell.
template <int D>
struct Passers {
  std::vector<Body<D>> bodies;
  std::vector<Motion<D>> motions;

  PassingBody<D, float> passing(std::uint32_t slot) const {
    const Body<D>& body = bodies[slot];
    const Motion<D>& motion = motions[slot];
    const bool yields = body.kind == BodyKind::kDynamic || body.kind == BodyKind::kParticle;
    return {body.position, body.extent,           yields ? body.thickness : kUnyielding,
            motion.spin,   motion.delta_position, motion.delta_rotation};
  }
};

template <int N>
static Vec<N> drawn_vector(std::mt19937& random, float most) {
  Vec<N> vector;
  for (float& value : vector.v) value = drawn(random, most);
  return vector;
}

template <int D>
static Passers<D> drawn_passers(std::mt19937& random, int count) {
  constexpr BodyKind kKinds[4] = {BodyKind::kStatic, BodyKind::kKinematic, BodyKind::kDynamic,
                                  BodyKind::kParticle};
  Passers<D> passers;
  for (int i = 0; i < count; ++i) {
    Body<D> body{};
    body.kind = kKinds[random() % 4];
    body.position = drawn_vector<D>(random, 3.0f);
    body.extent = 1.5f + drawn(random, 1.0f);
    body.thickness = 0.5f + drawn(random, 0.5f);
    passers.bodies.push_back(body);
    const float turn = random() % 4 == 0 ? 3.0f : 0.1f;
    const float spin = random() % 8 == 0 ? 400.0f : 5.0f;
    passers.motions.push_back({Vec<D>::zero(), drawn_vector<Dim<D>::kSpin>(random, spin),
                               drawn_vector<D>(random, 0.3f),
                               rotation_by(drawn_vector<Dim<D>::kSpin>(random, turn))});
  }
  return passers;
}

template <int D>
static void expect_who_can_pass_at_every_width() {
  std::mt19937 random(20261128);
  int passing = 0;
  int asked = 0;
  for (int round = 0; round < 320; ++round) {
    const int count = 1 + round % 64;
    const Passers<D> passers = drawn_passers<D>(random, 2 * count);
    BodyPairs pairs;
    std::uint64_t expected = 0;
    for (std::uint32_t slot = 0; pairs.count < count; ++pairs.count, slot += 2) {
      pairs.a[pairs.count] = slot;
      pairs.b[pairs.count] = slot + 1;
      const bool passes = can_pass(kTick, passers.passing(slot), passers.passing(slot + 1)) > 0.0f;
      if (passes) expected |= std::uint64_t{1} << pairs.count;
      passing += passes ? 1 : 0;
      ++asked;
    }
    for_each_width<1, 4>([&]<int W>() {
      EXPECT_EQ(expected, BodyKernels<W>::can_pass(kTick, passers.bodies.data(),
                                                   passers.motions.data(), pairs))
          << "width " << W << ", round " << round;
    });
    ASSERT_FALSE(testing::Test::HasFailure());
  }
  EXPECT_GT(passing, 1000);
  EXPECT_GT(asked - passing, 1000);
}

TEST(BodyKernels, FindWhoCanPassThroughTheOtherAtEveryWidth) {
  expect_who_can_pass_at_every_width<2>();
  expect_who_can_pass_at_every_width<3>();
}

}  // namespace cycloid::solver
