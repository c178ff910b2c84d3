#include "solver/tracing/compare_encodings.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "solver/tracing/writes.hpp"
#include "solver/world.hpp"
#include "tests/solver/encoding_fixture.hpp"

namespace cycloid::solver {
namespace {

/// Two balls that lie on a half-space.
World<2> two_balls() {
  WorldDef<2> def;
  def.gravity[1] = -10.0f;
  World<2> world = std::move(World<2>::create(def).value());
  ShapeDef<2> plane;
  plane.kind = ShapeKind::kHalfSpace;
  plane.normal[1] = 1.0f;
  BodyDef<2> floor;
  floor.kind = BodyKind::kStatic;
  EXPECT_TRUE(world.create_body(floor, {&plane, 1}).ok());
  ShapeDef<2> ball;
  ball.kind = ShapeKind::kBall;
  ball.radius = 0.5f;
  ball.points = {Vec<2>::zero()};
  for (const float x : {-2.0f, 2.0f}) {
    BodyDef<2> body;
    body.position[0] = x;
    body.position[1] = 0.5f;
    EXPECT_TRUE(world.create_body(body, {&ball, 1}).ok());
  }
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(world.step().ok());
  return world;
}

TEST(CompareEncodings, NamesTheNumberAndBothValues) {
  const World<2> world = two_balls();
  WorldState<2> other = world.state();
  other.bodies.moved(2).velocity[1] = 0.25f;
  const auto compared = compare_encodings(bytes_of(world.state()), bytes_of(other), 8);
  ASSERT_TRUE(compared.ok());
  ASSERT_EQ(compared.value().first.size(), 1u);
  EXPECT_EQ(compared.value().count, 1u);
  const EncodedDifference& found = compared.value().first[0];
  EXPECT_EQ(found.object(), "body 2");
  EXPECT_EQ(found.field, "velocity[1]");
  EXPECT_EQ(found.value_b, "0.25 (0x3e800000)");
}

TEST(CompareEncodings, TakesZerosAndNaNsForOneAsTheDigestDoes) {
  const World<2> world = two_balls();
  WorldState<2> a = world.state();
  WorldState<2> b = a;
  a.bodies.moved(1).force[0] = 0.0f;
  b.bodies.moved(1).force[0] = -0.0f;
  a.bodies.moved(1).torque = std::bit_cast<decltype(a.bodies[1].torque)>(0x7fc00001u);
  b.bodies.moved(1).torque = std::bit_cast<decltype(a.bodies[1].torque)>(0xffc00000u);
  EXPECT_EQ(compare_encodings(bytes_of(a), bytes_of(b), 8).value().count, 0u);
  EXPECT_EQ(digest_encoding(bytes_of(a)), digest_encoding(bytes_of(b)));
}

TEST(CompareEncodings, MatchesContactsByTheirShapes) {
  const World<2> world = two_balls();
  ASSERT_EQ(world.state().contacts.size(), 2u);
  WorldState<2> other = world.state();
  other.contacts.erase(other.contacts.begin());
  const auto compared = compare_encodings(bytes_of(world.state()), bytes_of(other), 8);
  ASSERT_EQ(compared.value().count, 1u);
  EXPECT_EQ(compared.value().first[0].object(), "contact 0");
  EXPECT_EQ(compared.value().first[0].value_a, "present");
  EXPECT_EQ(compared.value().first[0].value_b, "absent");
  EXPECT_EQ(compared.value().first[0].about, "bodies 0 and 1, shapes 0 and 1");
}

TEST(CompareEncodings, NamesAtMostAsManyAsAskedForAndCountsTheRest) {
  const World<2> world = two_balls();
  WorldState<2> other = world.state();
  for (std::size_t i = 0; i < other.bodies.size(); ++i) other.bodies.moved(i).position[0] += 1.0f;
  other.contacts[1].points[0].normal_impulse += 1.0f;
  const auto compared = compare_encodings(bytes_of(world.state()), bytes_of(other), 2);
  EXPECT_EQ(compared.value().count, 4u);
  EXPECT_EQ(compared.value().objects, 4u);
  ASSERT_EQ(compared.value().first.size(), 2u);
  EXPECT_EQ(compared.value().first[0].kind, "contact");
}

TEST(CompareEncodings, IndicesAndFloatsMayBeAnything) {
  const World<2> world = two_balls();
  WorldState<2> other = world.state();
  other.contacts[0].shape_a = 0xfffffff0u;
  other.bodies.edit_one(1, [](Body<2>& body) {
    body.first_shape = 77;
    body.kind = BodyKind(99);
  });
  const auto bytes = bytes_of(other);
  EXPECT_TRUE(compare_encodings(bytes_of(world.state()), bytes, 100).ok());
  EXPECT_TRUE(compare_encodings(bytes, bytes_of(world.state()), 100).ok());
}

TEST(CompareEncodings, RefusesWhatIsCutOrOfAnotherDimension) {
  const World<2> world = two_balls();
  const auto bytes = bytes_of(world.state());
  for (std::size_t size = 0; size < bytes.size(); size += 61)
    EXPECT_FALSE(compare_encodings(bytes, std::span(bytes).first(size), 4).ok()) << size;
  const World<3> spatial = std::move(World<3>::create({}).value());
  std::vector<std::byte> other;
  spatial.encode(other);
  EXPECT_EQ(compare_encodings(bytes, other, 4).error().code, Code::kInvalid);
  EXPECT_EQ(digest_encoding(bytes), world.digest());
  EXPECT_EQ(digest_encoding(other), spatial.digest());
  EXPECT_FALSE(digest_encoding(std::span(bytes).first(9)));
}

TEST(PhasesThatWrite, AreThoseThatChangeTheField) {
  World<2> world = two_balls();
  StepTrace trace;
  trace.wants_fields = "body 1";
  world.trace_state(trace);
  ASSERT_TRUE(world.step_traced(trace).ok());
  const auto velocity = phases_that_write(trace, "body 1", "velocity[1]");
  ASSERT_FALSE(velocity.empty());
  EXPECT_EQ(velocity.front().phase, Phase::kVelocities);  // Gravity comes first.
  EXPECT_TRUE(phases_that_write(trace, "body 1", "mass").empty());
  EXPECT_TRUE(phases_that_write(trace, "body 1", "no such field").empty());
}

}  // namespace
}  // namespace cycloid::solver
