#include "client/replica/interpolator.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace cycloid::client {
namespace {

using scenes::Pose;

Pose pose(std::uint32_t index, float x, float angle = 0.0f, std::uint32_t generation = 1) {
  Pose pose;
  pose.index = index;
  pose.generation = generation;
  pose.position = {x, 2.0f * x, 0.0f};
  pose.rotation = {0.0f, 0.0f, std::sin(angle / 2), std::cos(angle / 2)};
  return pose;
}

float angle_of(const Pose& pose) {
  return 2.0f * std::atan2(pose.rotation[2], pose.rotation[3]);
}

Interpolator with(std::initializer_list<std::pair<std::uint64_t, std::vector<Pose>>> states) {
  Interpolator interpolator;
  for (const auto& state : states) interpolator.add(state.first, state.second);
  return interpolator;
}

TEST(Interpolation, GoesStraightAndTurnsAtAConstantRateBetweenTwoStates) {
  const Interpolator states = with({{10, {pose(0, 1.0f, 0.2f)}}, {12, {pose(0, 2.0f, 1.0f)}}});
  for (const double tick : {10.0, 10.5, 11.0, 11.75, 12.0}) {
    const auto poses = states.at(tick);
    ASSERT_EQ(poses.size(), 1u);
    const float part = static_cast<float>(tick - 10.0) / 2.0f;
    EXPECT_NEAR(poses[0].position[0], 1.0f + part, 1e-6);
    EXPECT_NEAR(poses[0].position[1], 2.0f + 2.0f * part, 1e-6);
    EXPECT_NEAR(angle_of(poses[0]), 0.2f + 0.8f * part, 1e-6);
  }
}

TEST(Interpolation, TurnsTheShorterWayRoundWhateverTheSignOfTheQuaternion) {
  Pose end = pose(0, 0.0f, 0.4f);
  for (float& value : end.rotation) value = -value;
  const Interpolator states = with({{0, {pose(0, 0.0f, 0.0f)}}, {1, {end}}});
  const auto middle = states.at(0.5);
  EXPECT_NEAR(std::abs(angle_of(middle[0])), 0.2f, 1e-6);
  const Interpolator far = with({{0, {pose(0, 0.0f, 3.0f)}}, {1, {pose(0, 0.0f, -3.0f)}}});
  EXPECT_NEAR(std::abs(std::remainder(angle_of(far.at(0.5)[0]), 6.2831853f)), 3.1415927f, 1e-5);
}

TEST(Interpolation, RotationsStayOfUnitLength) {
  const Interpolator states = with({{0, {pose(0, 0.0f, 0.0f)}}, {1, {pose(0, 0.0f, 3.1f)}}});
  for (double tick = 0.0; tick < 12.0; tick += 0.1) {
    float squares = 0.0f;
    for (const float value : states.at(tick)[0].rotation) squares += value * value;
    EXPECT_NEAR(squares, 1.0f, 1e-5);
  }
}

TEST(Interpolation, GoesOnBeyondTheNewestStateForABoundedTime) {
  const Interpolator states = with({{10, {pose(0, 0.0f)}}, {11, {pose(0, 1.0f, 0.1f)}}});
  EXPECT_NEAR(states.at(13.0)[0].position[0], 3.0f, 1e-5);
  EXPECT_NEAR(angle_of(states.at(13.0)[0]), 0.3f, 1e-5);
  EXPECT_NEAR(states.at(17.0)[0].position[0], 7.0f, 1e-5);
  EXPECT_NEAR(states.at(1000.0)[0].position[0], 7.0f, 1e-5) << "six ticks and no more";
  const Interpolator one = with({{10, {pose(0, 4.0f)}}});
  EXPECT_EQ(one.at(50.0)[0].position[0], 4.0f);
  EXPECT_EQ(one.at(5.0)[0].position[0], 4.0f);
  EXPECT_TRUE(Interpolator().at(3.0).empty());
}

TEST(Interpolation, ABodyThatWasPutElsewhereIsNeverShownOnTheWay) {
  const Interpolator states = with({{10, {pose(0, 0.0f)}}, {12, {pose(0, 100.0f)}}});
  EXPECT_EQ(states.at(11.9)[0].position[0], 0.0f);
  EXPECT_EQ(states.at(12.0)[0].position[0], 100.0f);
  EXPECT_EQ(states.at(14.0)[0].position[0], 100.0f);
}

TEST(Interpolation, BodiesThatComeAndGoAreShownInTheirTime) {
  const Interpolator states =
      with({{10, {pose(0, 0.0f), pose(3, 5.0f)}}, {11, {pose(0, 1.0f), pose(2, 7.0f)}}});
  const auto before = states.at(10.5);
  ASSERT_EQ(before.size(), 2u);
  EXPECT_EQ(before[1].index, 3u);
  EXPECT_EQ(before[1].position[0], 5.0f);
  const auto after = states.at(11.0);
  ASSERT_EQ(after.size(), 2u);
  EXPECT_EQ(after[1].index, 2u);
  EXPECT_EQ(states.at(12.0).size(), 2u);
}

TEST(Interpolation, ASlotThatIsUsedAgainIsAnotherBody) {
  const Interpolator states =
      with({{10, {pose(5, 0.0f, 0.0f, 1)}}, {11, {pose(5, 1.0f, 0.0f, 2)}}});
  EXPECT_EQ(states.at(10.9)[0].generation, 1u);
  EXPECT_EQ(states.at(10.9)[0].position[0], 0.0f);
  EXPECT_EQ(states.at(11.0)[0].generation, 2u);
}

TEST(Interpolation, ARewindReplacesWhatWasLater) {
  Interpolator states = with({{10, {pose(0, 0.0f)}}, {11, {pose(0, 1.0f)}}, {12, {pose(0, 2.0f)}}});
  states.add(11, std::vector<Pose>{pose(0, -1.0f)});
  EXPECT_EQ(states.newest_tick(), 11u);
  EXPECT_NEAR(states.at(10.5)[0].position[0], -0.5f, 1e-6);
}

TEST(Interpolation, AtNoNumberShowsTheNewestState) {
  const Interpolator states = with({{10, {pose(0, 0.0f)}}, {11, {pose(0, 1.0f)}}});
  const auto poses = states.at(std::nan(""));
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0].position[0], 1.0f);
}

TEST(Interpolation, KeepsABoundedNumberOfStates) {
  Interpolator states;
  for (std::uint64_t tick = 0; tick < 1000; ++tick)
    states.add(tick, std::vector<Pose>{pose(0, static_cast<float>(tick))});
  EXPECT_EQ(states.states(), InterpolatorOptions{}.states_max);
  EXPECT_NEAR(states.at(990.5)[0].position[0], 990.5f, 1e-3);
}

TEST(Events, AreToldWhenTheirTickIsShown) {
  EventFeed feed;
  protocol::InputFrame frame;
  frame.tick = 20;
  frame.events.push_back({protocol::EventKind::kJoin, 1});
  feed.add(19, std::vector<Pose>{pose(0, 0.0f)});
  feed.add(frame);
  feed.add(20, std::vector<Pose>{pose(0, 0.0f, 0.0f, 2), pose(4, 0.0f)});
  frame.tick = 22;
  frame.events[0] = {protocol::EventKind::kLeave, 1};
  feed.add(frame);
  feed.add(21, std::vector<Pose>{pose(0, 3.0f, 0.0f, 2), pose(4, 0.0f)});
  EXPECT_TRUE(feed.take_until(18.9).empty());
  const auto taken = feed.take_until(21.5);
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_EQ(taken[0].tick, 19u);
  EXPECT_EQ(taken[0].bodies, (std::vector<BodyChange>{{true, 0, 1}}));
  EXPECT_EQ(taken[1].tick, 20u);
  EXPECT_EQ(taken[1].seats.at(0).kind, protocol::EventKind::kJoin);
  EXPECT_EQ(taken[1].bodies, (std::vector<BodyChange>{{false, 0, 1}, {true, 0, 2}, {true, 4, 1}}));
  EXPECT_EQ(feed.take_until(22.0).at(0).seats.at(0).kind, protocol::EventKind::kLeave);
}

TEST(Events, ThatNobodyTakesAreBoundedAndCounted) {
  EventFeed feed;
  protocol::InputFrame frame;
  frame.events.push_back({protocol::EventKind::kJoin, 1});
  for (frame.tick = 1; frame.tick <= EventFeed::kTicksMax + 10; ++frame.tick) feed.add(frame);
  EXPECT_EQ(feed.lost(), 10u);
  EXPECT_EQ(feed.take_until(1e9).size(), EventFeed::kTicksMax);
}

}  // namespace
}  // namespace cycloid::client
