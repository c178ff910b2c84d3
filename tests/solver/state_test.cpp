#include <functional>
#include <map>

#include "solver/bytes.hpp"
#include "solver/encoding.hpp"
#include "solver/visit.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// A world in which every record and every field is in use: contacts, both joints, a hole in each
/// slot array, pending forces, registers.
World<2> busy_world() {
  WorldDef<2> def = with_gravity<2>({0.5f, 0.2f});
  World<2> world = make_world(def);
  add_ground<2>(world, up<2>());
  const BodyId gone = add_at<2>(world, {{9.0f, 5.0f}}, ball<2>(0.5f));
  const BodyId a = add_at<2>(world, {{0.0f, 0.5f}}, box(0.5f, 0.5f));
  const BodyId b = add_at<2>(world, {{0.1f, 1.45f}}, capsule(0.3f, 0.4f));
  const BodyId c = add_at<2>(world, {{2.0f, 2.0f}}, ball<2>(0.3f));
  JointDef<2> pin;
  pin.body_a = b;
  pin.body_b = c;
  pin.anchor_a = {{1.9f, 0.55f}};
  pin.limit_enabled = true;
  pin.lower = -0.1f;
  pin.upper = 0.1f;
  pin.motor = MotorKind::kSpeed;
  pin.motor_speed = 1.0f;
  pin.motor_max = 2.0f;
  EXPECT_TRUE(world.create_joint(pin).ok());
  JointDef<2> rope;
  rope.kind = JointKind::kDistance;
  rope.body_a = a;
  rope.body_b = c;
  rope.length = 2.0f;
  rope.hertz = 3.0f;
  rope.damping_ratio = 0.5f;
  const JointId removed = world.create_joint(rope).value();
  EXPECT_TRUE(world.create_joint(rope).ok());
  EXPECT_TRUE(world.destroy_joint(removed).ok());
  EXPECT_TRUE(world.destroy_body(gone).ok());
  EXPECT_TRUE(world.resize_registers(3).ok());
  EXPECT_TRUE(world.set_register(1, 7).ok());
  step(world, 20);
  EXPECT_TRUE(world.apply_force(c, {{1.0f, 2.0f}}).ok());
  EXPECT_TRUE(world.apply_torque(c, {{0.5f}}).ok());
  return world;
}

/// Flips the lowest bit of number `target` of the state; returns where that number is.
template <int D>
std::string flip_word(WorldState<D>& state, std::size_t target) {
  std::size_t at = 0;
  std::string where;
  const auto flip = [&](const char* object) {
    return [&, object](auto& value) {
      if (at++ != target) return;
      where = object;
      using T = std::remove_cvref_t<decltype(value)>;
      value = std::bit_cast<T>(static_cast<decltype(bits_of(value))>(bits_of(value) ^ 1u));
    };
  };
  visit_words(state.header, flip("header"));
  visit_arrays(state, [&](const char* name, auto& array) {
    for (auto& element : array) visit_words(element, flip(name));
  });
  return where;
}

TEST(Digest, ChangesWithTheLowestBitOfEveryNumberOfTheState) {
  World<2> world = busy_world();
  const WorldState<2> original = world.state();
  const std::uint64_t digest = world.digest();
  std::map<std::string, int> flipped;
  for (std::size_t word = 0;; ++word) {
    WorldState<2> state = original;
    const std::string where = flip_word(state, word);
    if (where.empty()) break;
    ++flipped[where];
    world.restore(state);
    // A lone sign of zero is the one change that the digest may not see; bit 0 is not a sign.
    ASSERT_NE(world.digest(), digest) << where << ", number " << word;
  }
  for (const char* array : {"header", "material", "body", "free body", "shape", "free shape",
                            "joint", "free joint", "contact", "register"})
    EXPECT_GT(flipped[array], 0) << array;
}

// What Box2D's state hash does not see: each call alone changes the digest at once.
TEST(Digest, ChangesAtOnceWithEveryCallThatChangesTheFuture) {
  const BodyId c = {4, 0};
  const JointId pin = {0, 0};
  const JointId rope = {2, 0};
  const std::vector<std::pair<const char*, std::function<Error(World<2>&)>>> calls = {
      {"gravity",
       [](auto& w) {
         return w.set_gravity({{0.0f, -9.0f}});
       }},
      {"force",
       [&](auto& w) {
         return w.apply_force(c, {{1.0f, 0.0f}});
       }},
      {"torque", [&](auto& w) { return w.apply_torque(c, {{1.0f}}); }},
      {"impulse",
       [&](auto& w) {
         return w.apply_impulse(c, {{1.0f, 0.0f}});
       }},
      {"angular impulse", [&](auto& w) { return w.apply_angular_impulse(c, {{1.0f}}); }},
      {"velocity",
       [&](auto& w) {
         return w.set_velocity(c, {{9.0f, 0.0f}}, {{0.0f}});
       }},
      {"pose",
       [&](auto& w) {
         return w.set_pose(c, {{9.0f, 9.0f}}, {{1.0f, 0.0f}});
       }},
      {"friction",
       [](auto& w) {
         return w.set_material(0, {0.4f, 0.2f});
       }},
      {"restitution",
       [](auto& w) {
         return w.set_material(0, {0.5f, 0.3f});
       }},
      {"gravity scale", [&](auto& w) { return w.set_gravity_scale(c, 0.5f); }},
      {"damping", [&](auto& w) { return w.set_damping(c, 0.1f, 0.0f); }},
      {"mass", [&](auto& w) { return w.set_mass(c, 5.0f); }},
      {"filter",
       [&](auto& w) {
         return w.set_filter(c, 0, {1, 2, 0});
       }},
      {"motor", [&](auto& w) { return w.set_motor(pin, true, 2.0f, 2.0f); }},
      {"target", [&](auto& w) { return w.set_target(pin, 0.1f, 2.0f); }},
      {"anchor",
       [&](auto& w) {
         return w.set_anchor(pin, {{0.1f, 0.2f}});
       }},
      {"limits", [&](auto& w) { return w.set_limits(pin, true, -0.2f, 0.1f); }},
      {"spring", [&](auto& w) { return w.set_spring(rope, 2.0f, 4.0f, 0.5f); }},
      {"register", [](auto& w) { return w.set_register(0, 1); }},
      {"tuning",
       [](auto& w) {
         Tuning tuning = w.tuning();
         tuning.slop = 0.004f;
         return w.set_tuning(tuning);
       }},
  };
  for (const auto& [name, call] : calls) {
    World<2> world = busy_world();
    const std::uint64_t before = world.digest();
    const Error error = call(world);
    ASSERT_TRUE(error.ok()) << name << ": " << error.field;
    EXPECT_NE(world.digest(), before) << name;
    // What is kept of what no tick changes is no other than what is made of it anew.
    std::vector<std::byte> bytes;
    world.encode(bytes);
    EXPECT_EQ(world.digest(), digest_encoding(bytes)) << name;
  }
}

TEST(Snapshot, RestoreFromMemoryAndFromBytesGoesOnBitForBit) {
  World<2> world = busy_world();
  WorldState<2> saved;
  world.save(saved);
  std::vector<std::byte> bytes;
  world.encode(bytes);
  World<2> from_memory = make_world<2>();
  from_memory.restore(saved);
  World<2> from_bytes = make_world<2>();
  ASSERT_TRUE(from_bytes.decode(bytes).ok());
  for (int tick = 0; tick < 300; ++tick) {
    ASSERT_EQ(world.digest(), from_memory.digest()) << "tick " << tick;
    ASSERT_EQ(world.digest(), from_bytes.digest()) << "tick " << tick;
    step(world, 1);
    step(from_memory, 1);
    step(from_bytes, 1);
    if (tick == 100) {
      // Creation after a restore takes the same slots: free lists are part of the state.
      const BodyId id = add_at<2>(world, {{0.0f, 6.0f}}, ball<2>(0.4f));
      EXPECT_EQ(id, add_at<2>(from_memory, {{0.0f, 6.0f}}, ball<2>(0.4f)));
      EXPECT_EQ(id, add_at<2>(from_bytes, {{0.0f, 6.0f}}, ball<2>(0.4f)));
    }
  }
}

TEST(Snapshot, OfARopeShorterThanAnyRodIsReadBackWhenItsLimitsAreOff) {
  for (const float length : {0.0f, 1e-30f, 5e-5f, 2.0f}) {
    World<2> world = make_world<2>();
    JointDef<2> rope;
    rope.kind = JointKind::kDistance;
    rope.body_a = add_at<2>(world, {{0.0f, 0.0f}}, ball<2>(0.5f));
    rope.body_b = add_at<2>(world, {{2.0f, 0.0f}}, ball<2>(0.5f));
    rope.length = length;
    rope.limit_enabled = true;
    rope.upper = 3.0f;
    const JointId id = world.create_joint(rope).value();
    EXPECT_TRUE(world.set_limits(id, false, 0.0f, 3.0f).ok());
    std::vector<std::byte> bytes;
    world.encode(bytes);
    World<2> other = make_world<2>();
    EXPECT_TRUE(other.decode(bytes).ok()) << length;
    EXPECT_EQ(other.digest(), world.digest()) << length;
  }
}

TEST(Snapshot, TruncationAtEveryByteIsRefusedAndChangesNothing) {
  World<2> world = busy_world();
  std::vector<std::byte> bytes;
  world.encode(bytes);
  World<2> other = make_world<2>();
  const std::uint64_t before = other.digest();
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    ASSERT_EQ(other.decode(std::span(bytes).first(length)).code, Code::kCorrupt) << length;
  }
  bytes.push_back(std::byte{0});
  EXPECT_EQ(other.decode(bytes).code, Code::kCorrupt);
  EXPECT_EQ(other.digest(), before);
}

// Every single-bit flip is refused, or gives a state that steps without touching foreign memory
// (the sanitizer preset runs this too) and whose digest tells it from the original.
TEST(Snapshot, EverySingleBitFlipIsRefusedOrSeenInTheDigest) {
  World<2> world = busy_world();
  const std::uint64_t digest = world.digest();
  std::vector<std::byte> bytes;
  world.encode(bytes);
  World<2> other = make_world<2>();
  int refused = 0;
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    std::vector<std::byte> flipped = bytes;
    flipped[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
    if (!other.decode(flipped).ok()) {
      ++refused;
      continue;
    }
    if (other.digest() == digest) {
      // Only the sign of a zero is not in the digest.
      ASSERT_EQ(bit % 32, 31u) << "bit " << bit;
    }
    (void)other.step();
  }
  EXPECT_GT(refused, 100);
}

TEST(Snapshot, OfATickThatNoMatchHasIsRefused) {
  World<2> world = make_world<2>();
  WorldState<2> state;
  world.save(state);
  World<2> other = make_world<2>();
  for (const std::uint64_t tick : {kTickEnd - 1, kTickEnd, ~std::uint64_t{0}}) {
    state.header.tick = tick;
    world.restore(state);
    std::vector<std::byte> bytes;
    world.encode(bytes);
    EXPECT_EQ(other.decode(bytes).ok(), tick < kTickEnd) << tick;
  }
}

TEST(Snapshot, OfTheOtherDimensionIsRefused) {
  std::vector<std::byte> bytes;
  busy_world().encode(bytes);
  World<3> space = make_world<3>();
  EXPECT_EQ(space.decode(bytes).code, Code::kCorrupt);
}

TEST(Differences, NameObjectFieldAndBothValues) {
  World<2> world = busy_world();
  WorldState<2> other = world.state();
  EXPECT_TRUE(differences(world.state(), other, 10).empty());
  other.bodies.moved(3).velocity[1] = 0.25f;
  const std::vector<Difference> found = differences(world.state(), other, 10);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].object, "body 3");
  EXPECT_EQ(found[0].field, "velocity[1]");
  EXPECT_EQ(found[0].value_b, "0.25 (0x3e800000)");
}

TEST(Fault, NamesTickBodyAndFieldAndKeepsTheStateOfTheTickBefore) {
  World<2> world = make_world<2>();
  BodyDef<2> def;
  def.position = {{9.9999e6f, 0.0f}};
  def.velocity = {{9.0e4f, 0.0f}};
  add_at<2>(world, {{0.0f, 0.0f}}, ball<2>(0.5f));
  const BodyId runaway = add(world, def, ball<2>(0.5f));
  Error error;
  while ((error = world.step()).ok()) ASSERT_LT(world.tick(), 100u);
  EXPECT_EQ(error.code, Code::kFaulted);
  EXPECT_STREQ(error.field, "position");
  ASSERT_TRUE(world.fault().has_value());
  EXPECT_EQ(world.fault()->body, runaway);
  EXPECT_EQ(world.fault()->tick, world.tick() + 1);
  EXPECT_LE(view(world, runaway).position[0], 1.0e7f);
  const std::uint64_t digest = world.digest();
  EXPECT_EQ(world.step().code, Code::kFaulted);
  EXPECT_EQ(world.digest(), digest);
  std::vector<std::byte> bytes;
  world.encode(bytes);
  World<2> copy = make_world<2>();
  ASSERT_TRUE(copy.decode(bytes).ok());
  EXPECT_EQ(copy.digest(), digest);
  EXPECT_EQ(copy.step().code, Code::kFaulted);
}

}  // namespace cycloid::solver
