#include "tests/solver/random_fixture.hpp"
#include "tests/solver/space_fixture.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {
namespace {

/// Few bodies of all masses, thrown on one heap, some joined, and pushed by forces and torques up
/// to what a call takes: sums in the sweeps leave what float can hold, and most plays end in a
/// fault. In lanes beside others 0 times infinity is not 0.
template <int D>
class Extremes {
 public:
  explicit Extremes(unsigned seed) : random_(seed), world_(make_world(definition())) {
    const int bodies = 3 + one_of(10);
    const float spread = power_of_ten(-2, 0);
    for (int i = 0; i < bodies; ++i) add_one(i, spread);
    for (int joint = one_of(4); joint > 0; --joint) join_two();
  }

  /// Up to three ticks, or up to a fault. @returns the world, which stays this play's own.
  World<D>& play(int lanes) {
    EXPECT_TRUE(world_.set_lanes(lanes).ok());
    for (int tick = 1 + one_of(3); tick > 0; --tick) {
      for (int pushed = 1 + one_of(3); pushed > 0; --pushed) push(ids_[at_random()]);
      if (!world_.step().ok()) break;
    }
    return world_;
  }

 private:
  int one_of(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }
  std::size_t at_random() { return random_() % ids_.size(); }
  /// From ten to the power of `lower` on, below that of `upper`. By products alone: libraries round
  /// powers differently, and a seed is to be the same world on every machine.
  float power_of_ten(int lower, int upper) {
    float value = uniform(random_, 1.0f, 10.0f);
    const int power = lower + one_of(upper - lower);
    for (int i = 0; i < power; ++i) value *= 10.0f;
    for (int i = power; i < 0; ++i) value *= 0.1f;
    return value;
  }
  Vec<D> within(float bound) {
    Vec<D> vector;
    for (float& value : vector.v) value = uniform(random_, -bound, bound);
    return vector;
  }

  WorldDef<D> definition() {
    WorldDef<D> def;
    if (one_of(2) == 0) def.gravity[1] = -10.0f;
    def.materials = {Material{}, Material{}};
    if (one_of(3) == 0) def.materials[0].friction = 0.0f;
    def.materials[1].restitution = one_of(2) == 0 ? 1.0f : 0.5f;
    if (one_of(3) == 0) def.materials[1].rolling_resistance = 0.2f;
    return def;
  }

  ShapeDef<D> shape() {
    const float size = power_of_ten(-2, 0);
    ShapeDef<D> of = ball<D>(size);
    if (one_of(2) == 0) {
      of = brick(size);
    } else if (one_of(2) == 0) {
      of.kind = ShapeKind::kCapsule;
      of.points = {at<D>(-size, 0.0f), at<D>(size, 0.0f)};
    }
    of.material = static_cast<std::uint32_t>(one_of(2));
    return of;
  }
  static ShapeDef<D> brick(float size) {
    if constexpr (D == 2)
      return box(size, 0.5f * size);
    else
      return box_def({{size, 0.5f * size, 0.7f * size}});
  }

  void add_one(int number, float spread) {
    BodyDef<D> def;
    def.position = within(spread);
    if (number == 0 && one_of(2) == 0) {
      def.kind = BodyKind::kStatic;
    } else {
      if (one_of(4) == 0) def.mass = power_of_ten(-8, 10);
      if (one_of(5) == 0) def.velocity = within(9.0e4f);
    }
    ids_.push_back(add(world_, def, shape()));
  }

  /// Some two are one, or too far apart, and refused.
  void join_two() {
    JointDef<D> def;
    def.kind = one_of(2) == 0 ? JointKind::kRevolute : JointKind::kDistance;
    def.body_a = ids_[at_random()];
    def.body_b = ids_[at_random()];
    def.anchor_a = within(1.0f);
    def.length = 0.5f;
    (void)world_.create_joint(def);
  }

  void push(BodyId id) {
    const float most = power_of_ten(6, 12);
    if (one_of(2) == 0) {
      EXPECT_TRUE(world_.apply_force(id, within(most)).ok());
    }
    if (one_of(2) == 0) {
      Spin<D> torque;
      for (float& value : torque.v) value = uniform(random_, -most, most);
      EXPECT_TRUE(world_.apply_torque(id, torque).ok());
    }
  }

  std::mt19937 random_;
  World<D> world_;
  std::vector<BodyId> ids_;
};

/// @returns how many plays have ended in a fault.
template <int D>
int expect_the_same_ends(unsigned plays) {
  int faults = 0;
  for (unsigned seed = 1; seed <= plays; ++seed) {
    Extremes<D> alone(seed);
    const World<D>& one = alone.play(1);
    if (one.fault().has_value()) ++faults;
    for (const int lanes : {4, 8, 16}) {
      Extremes<D> beside(seed);
      const World<D>& other = beside.play(lanes);
      EXPECT_EQ(one.digest(), other.digest()) << "seed " << seed << ", lanes " << lanes;
      EXPECT_EQ(one.fault().has_value(), other.fault().has_value()) << "seed " << seed;
      if (!one.fault().has_value() || !other.fault().has_value()) continue;
      EXPECT_EQ(one.fault()->body.index, other.fault()->body.index) << "seed " << seed;
      EXPECT_EQ(one.fault()->field, other.fault()->field) << "seed " << seed;
    }
  }
  return faults;
}

// Without World::step_in_one_lane 18 of these plays in the plane and 23 in space name another body
// or field in lanes than alone.
TEST(FaultsInLanes, AreOfTheSameBodyAndFieldInThePlane) {
  EXPECT_GT(expect_the_same_ends<2>(1000), 200);
}

TEST(FaultsInLanes, AreOfTheSameBodyAndFieldInSpace) {
  EXPECT_GT(expect_the_same_ends<3>(1000), 200);
}

}  // namespace
}  // namespace cycloid::solver
