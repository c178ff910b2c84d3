#include <gtest/gtest.h>

#include <random>

#include "solver/world.hpp"

namespace cycloid::history {
namespace {

using solver::BodyId;
using solver::JointId;
using solver::LinkId;
using solver::ParticleId;
using solver::PinId;
using solver::World;

/// A world that gives out and takes back ids of every kind, by chance that its seed fixes.
template <int D>
class Churn {
 public:
  explicit Churn(std::uint32_t seed) : world_(make()), random_(seed) {}

  static World<D> make() {
    solver::WorldDef<D> def;
    def.gravity[1] = -10.0f;
    def.tuning.particle_substeps = 4;
    return std::move(World<D>::create(def).value());
  }

  /// Makes or destroys something; the id that came out, or what was refused.
  std::string act() {
    switch (random_() % 10) {
      case 0:
        return destroy(bodies_, [&](BodyId id) { return world_.destroy_body(id); });
      case 1:
        return destroy(joints_, [&](JointId id) { return world_.destroy_joint(id); });
      case 2:
        return destroy(particles_, [&](ParticleId id) { return world_.destroy_particle(id); });
      case 3:
        return destroy(links_, [&](LinkId id) { return world_.destroy_link(id); });
      case 4:
        return destroy(pins_, [&](PinId id) { return world_.destroy_pin(id); });
      case 5:
        return joint();
      case 6:
        return particle();
      case 7:
        return keep(world_.create_link({one(particles_), one(particles_), 0.5f, 0.0f}), links_);
      case 8: {
        const ParticleId particle = one(particles_);
        return keep(world_.create_pin({particle, one(bodies_), solver::Vec<D>::zero()}), pins_);
      }
      default:
        return body();
    }
  }

  std::vector<std::string> act(int times) {
    std::vector<std::string> ids;
    for (int i = 0; i < times; ++i) ids.push_back(act());
    return ids;
  }

  /// Goes on in another world, which has the same state.
  void go_on_in(World<D> world) { world_ = std::move(world); }
  World<D>& world() { return world_; }

 private:
  template <class Id>
  Id one(const std::vector<Id>& ids) {
    return ids.empty() ? Id{} : ids[random_() % ids.size()];
  }
  template <class Id>
  std::string keep(const solver::Result<Id>& made, std::vector<Id>& ids) {
    if (!made.ok()) return made.error().field;
    ids.push_back(made.value());
    return std::to_string(ids.back().index) + "." + std::to_string(ids.back().generation);
  }
  /// Ids that something else took with it are refused, which is an answer like any other.
  template <class Id, class Destroy>
  std::string destroy(std::vector<Id>& ids, Destroy&& call) {
    if (ids.empty()) return "none";
    const std::size_t which = random_() % ids.size();
    const solver::Error error = call(ids[which]);
    ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(which));
    return error.field;
  }
  float coordinate() { return 0.01f * static_cast<float>(random_() % 1000); }
  std::string body() {
    solver::BodyDef<D> def;
    for (int i = 0; i < D; ++i) def.position[i] = coordinate();
    solver::ShapeDef<D> ball;
    ball.radius = 0.2f;
    std::vector<solver::ShapeDef<D>> shapes(1 + random_() % 3, ball);
    return keep(world_.create_body(def, shapes), bodies_);
  }
  std::string particle() {
    solver::ParticleDef<D> def;
    for (int i = 0; i < D; ++i) def.position[i] = coordinate();
    return keep(world_.create_particle(def), particles_);
  }
  std::string joint() {
    solver::JointDef<D> def;
    def.body_a = one(bodies_);
    def.body_b = one(bodies_);
    return keep(world_.create_joint(def), joints_);
  }

  World<D> world_;
  std::mt19937 random_;
  std::vector<BodyId> bodies_;
  std::vector<JointId> joints_;
  std::vector<ParticleId> particles_;
  std::vector<LinkId> links_;
  std::vector<PinId> pins_;
};

template <int D>
void restored_ids_go_on() {
  Churn<D> original(D);
  Churn<D> restored(D);
  for (int round = 0; round < 40; ++round) {
    solver::WorldState<D> saved;
    std::vector<std::byte> bytes;
    restored.world().save(saved);
    restored.world().encode(bytes);
    // The one that comes back has meanwhile given out and taken back other ids.
    Churn<D> elsewhere(77);
    elsewhere.act(round * 5);
    if (round % 2 == 0) {
      elsewhere.world().restore(saved);
    } else {
      ASSERT_TRUE(elsewhere.world().decode(bytes).ok());
    }
    restored.go_on_in(std::move(elsewhere.world()));
    ASSERT_EQ(original.act(60), restored.act(60)) << "round " << round;
    ASSERT_EQ(original.world().digest(), restored.world().digest()) << "round " << round;
    ASSERT_TRUE(original.world().step().ok());
    ASSERT_TRUE(restored.world().step().ok());
    ASSERT_EQ(original.world().digest(), restored.world().digest()) << "round " << round;
  }
  const solver::WorldState<D>& state = original.world().state();
  EXPECT_FALSE(state.free_bodies.empty());
  EXPECT_FALSE(state.free_joints.empty());
  EXPECT_FALSE(state.free_particles.empty());
  EXPECT_FALSE(state.free_links.empty());
  EXPECT_FALSE(state.free_pins.empty());
}

TEST(Ids, GivenOutAfterARestoreAreThoseOfTheOriginal) {
  restored_ids_go_on<2>();
  restored_ids_go_on<3>();
}

template <int D>
void churn_is_undone() {
  Churn<D> churn(4);
  churn.act(200);
  solver::WorldState<D> before;
  churn.world().save(before);
  const std::uint64_t digest = churn.world().digest();
  churn.act(500);
  EXPECT_NE(churn.world().digest(), digest);
  churn.world().restore(before);
  EXPECT_EQ(churn.world().digest(), digest);
  EXPECT_TRUE(solver::differences(churn.world().state(), before, 1).empty());
  // And it steps as one that was never churned.
  World<D> fresh = Churn<D>::make();
  fresh.restore(before);
  for (int tick = 0; tick < 30; ++tick) {
    ASSERT_TRUE(fresh.step().ok());
    ASSERT_TRUE(churn.world().step().ok());
    ASSERT_EQ(fresh.digest(), churn.world().digest()) << "tick " << tick;
  }
}

TEST(Ids, CreatedAndDestroyedAfterASaveLeaveNoTraceOnceItIsRestored) {
  churn_is_undone<2>();
  churn_is_undone<3>();
}

// Removed and made again in the same order, slots come back the same, with later generations: an
// old id never names the new body.
template <int D>
void slots_come_back() {
  World<D> world = Churn<D>::make();
  solver::ShapeDef<D> ball;
  ball.radius = 0.2f;
  std::vector<BodyId> ids;
  for (int round = 0; round < 5; ++round) {
    for (const BodyId id : ids) {
      EXPECT_TRUE(world.destroy_body(id).ok());
      EXPECT_FALSE(world.contains(id));
    }
    std::vector<BodyId> made;
    for (int i = 0; i < 8; ++i) made.push_back(world.create_body({}, std::span(&ball, 1)).value());
    for (const BodyId id : ids) EXPECT_FALSE(world.contains(id));
    // The last that was freed is the first that is given out.
    for (std::size_t i = 0; i < ids.size(); ++i) {
      EXPECT_EQ(made[i].index, ids[ids.size() - 1 - i].index);
      EXPECT_EQ(made[i].generation, ids[ids.size() - 1 - i].generation + 1);
    }
    ids = made;
  }
}

TEST(Ids, SlotsComeBackInAFixedOrderWithANewGeneration) {
  slots_come_back<2>();
  slots_come_back<3>();
}

// Two worlds filled in turns, each as if it were alone.
template <int D>
void filled_in_turns() {
  Churn<D> alone(9);
  Churn<D> first(9);
  Churn<D> second(9);
  std::vector<Churn<D>> others;
  for (int round = 0; round < 300; ++round) {
    if (round % 50 == 0) others.emplace_back(static_cast<std::uint32_t>(round));
    for (Churn<D>& other : others) {
      other.act();
      ASSERT_TRUE(round % 7 != 0 || other.world().step().ok());
    }
    const std::string id = alone.act();
    ASSERT_EQ(first.act(), id);
    ASSERT_EQ(second.act(), id);
    for (Churn<D>* churn : {&alone, &first, &second})
      ASSERT_TRUE(round % 10 != 0 || churn->world().step().ok());
    ASSERT_EQ(alone.world().digest(), first.world().digest()) << "round " << round;
    ASSERT_EQ(alone.world().digest(), second.world().digest()) << "round " << round;
  }
}

TEST(Ids, BodiesInsertedInTurnsWithOtherWorldsAreThoseOfAWorldAlone) {
  filled_in_turns<2>();
  filled_in_turns<3>();
}

}  // namespace
}  // namespace cycloid::history
