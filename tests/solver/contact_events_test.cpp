#include <gtest/gtest.h>

#include <vector>

#include "tests/solver/method_settings.hpp"

namespace cycloid::solver {

/// Those and the two that solve islands at once, which let what rests sleep.
static std::vector<Setting> event_settings() {
  std::vector<Setting> all = method_settings();
  all.push_back({"soft_loaded", Tuning::soft_loaded()});
  all.push_back({"soft_islands", Tuning::soft_step()});
  all.back().tuning.contact_block = ContactBlockRows::kIsland;
  return all;
}

/// Weightless and without friction.
template <int D>
static World<D> bouncing_world(const Tuning& tuning, float restitution) {
  WorldDef<D> def = def_with<D>(tuning, {0.0f, restitution});
  def.gravity = Vec<D>::zero();
  return make_world(def);
}

template <int D>
static BodyId add_thrown(World<D>& world, const Vec<D>& position, const Vec<D>& velocity) {
  BodyDef<D> def;
  def.position = position;
  def.velocity = velocity;
  return add(world, def, ball<D>(0.25f));
}

template <int D>
static std::vector<ContactEvent> contact_events_of(World<D>& world, int ticks) {
  std::vector<ContactEvent> events;
  for (int i = 0; i < ticks; ++i) {
    step(world, 1);
    events.insert(events.end(), world.contact_events().begin(), world.contact_events().end());
  }
  return events;
}

/// From ten heights, so that ticks end at different distances from the ground.
template <int D>
static void check_bounces(const Setting& setting, float restitution, float speed) {
  for (int phase = 0; phase < 10; ++phase) {
    World<D> world = bouncing_world<D>(setting.tuning, restitution);
    const BodyId ground = add_ground<D>(world, up<D>());
    const float height = 1.003f + 0.052f * static_cast<float>(phase);
    const BodyId id = add_thrown<D>(world, at<D>(0.0f, height), at<D>(0.0f, -speed));
    std::vector<ContactEvent> expected = {{ground, id, 0, 0, true}};
    if (restitution > 0.0f) expected.push_back({ground, id, 0, 0, false});
    EXPECT_EQ(contact_events_of(world, 60), expected)
        << setting.name << " in " << D << "D, " << restitution << ", " << speed << ", " << phase;
  }
}

TEST(ContactEvents, ABounceBeginsAndEndsOnceUnderEachMethod) {
  for (const Setting& setting : event_settings())
    for (const float restitution : {1.0f, 0.5f, 0.0f})
      for (const float speed : {3.0f, 10.0f, 30.0f, 100.0f}) {
        check_bounces<2>(setting, restitution, speed);
        check_bounces<3>(setting, restitution, speed);
      }
}

// What does not restitute is at the surface for less than a tick where it only grazes it.
template <int D>
static void check_graze(const Setting& setting) {
  World<D> world = bouncing_world<D>(setting.tuning, 0.0f);
  BodyDef<D> def;
  def.kind = BodyKind::kStatic;
  const BodyId still = add(world, def, ball<D>(0.25f));
  const BodyId id = add_thrown<D>(world, at<D>(-0.7f, 0.49f), at<D>(12.0f, 0.0f));
  const std::vector<ContactEvent> expected = {{still, id, 0, 0, true}, {still, id, 0, 0, false}};
  EXPECT_EQ(contact_events_of(world, 60), expected) << setting.name << " in " << D << "D";
}

TEST(ContactEvents, AGrazeBeginsAndEndsOnceUnderEachMethod) {
  for (const Setting& setting : event_settings()) {
    check_graze<2>(setting);
    check_graze<3>(setting);
  }
}

// The middle one touches as the tick begins, the others in the course of it.
TEST(ContactEvents, AreToldInTheOrderOfTheShapesHoweverTheyBegan) {
  World<2> world = bouncing_world<2>(Tuning::soft_loaded(), 1.0f);
  const BodyId ground = add_ground<2>(world, up<2>());
  const BodyId a = add_thrown<2>(world, {{0.0f, 0.3f}}, {{0.0f, -10.0f}});
  const BodyId b = add_thrown<2>(world, {{1.0f, 0.25f}}, {{0.0f, 5.0f}});
  const BodyId c = add_thrown<2>(world, {{2.0f, 0.3f}}, {{0.0f, -10.0f}});
  const std::vector<ContactEvent> began = {
      {ground, a, 0, 0, true}, {ground, b, 0, 0, true}, {ground, c, 0, 0, true}};
  EXPECT_EQ(contact_events_of(world, 1), began);
  const std::vector<ContactEvent> ended = {
      {ground, a, 0, 0, false}, {ground, b, 0, 0, false}, {ground, c, 0, 0, false}};
  EXPECT_EQ(contact_events_of(world, 1), ended);
}

/// A world in the tick of a bounce, with the ball already apart from the ground.
struct Bounced {
  World<2> world = bouncing_world<2>(Tuning::soft_loaded(), 1.0f);
  BodyId ground = add_ground<2>(world, up<2>());
  BodyId id = add_thrown<2>(world, {{0.0f, 0.3f}}, {{0.0f, -10.0f}});
  std::vector<ContactEvent> began = contact_events_of(world, 1);
  std::vector<ContactEvent> ended = {{ground, id, 0, 0, false}};
};

TEST(ContactEvents, ARestoredWorldTellsTheEndOfABounce) {
  Bounced bounced;
  ASSERT_EQ(bounced.began.size(), 1u);
  World<2> other = make_world<2>();
  other.restore(bounced.world.state());
  EXPECT_EQ(contact_events_of(bounced.world, 10), bounced.ended);
  EXPECT_EQ(contact_events_of(other, 10), bounced.ended);
}

TEST(ContactEvents, ABounceEndsWithItsBody) {
  Bounced bounced;
  ASSERT_EQ(bounced.began.size(), 1u);
  ASSERT_TRUE(bounced.world.destroy_body(bounced.id).ok());
  EXPECT_EQ(contact_events_of(bounced.world, 10), bounced.ended);
}

// Two sleep a centimetre apart, near enough for a contact; a third one strikes the first.
TEST(ContactEvents, WhatIsStruckInItsSleepBeginsAndEndsOnce) {
  World<2> world = bouncing_world<2>(Tuning::soft_loaded(), 1.0f);
  const BodyId a = add_at<2>(world, {{0.0f, 0.0f}}, ball<2>(0.25f));
  const BodyId b = add_at<2>(world, {{0.51f, 0.0f}}, ball<2>(0.25f));
  EXPECT_TRUE(contact_events_of(world, 90).empty());
  ASSERT_EQ(world.statistics().asleep, 2u);
  const BodyId c = add_thrown<2>(world, {{-1.0f, 0.0f}}, {{10.0f, 0.0f}});
  std::vector<ContactEvent> of_sleepers;
  for (const ContactEvent& event : contact_events_of(world, 60))
    if (event.body_a == a && event.body_b == b) of_sleepers.push_back(event);
  const std::vector<ContactEvent> expected = {{a, b, 0, 0, true}, {a, b, 0, 0, false}};
  EXPECT_EQ(of_sleepers, expected);
  EXPECT_LT(length(view(world, c).velocity), 0.1f);
}

}  // namespace cycloid::solver
