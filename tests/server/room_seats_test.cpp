#include <gtest/gtest.h>

#include <algorithm>

#include "solver/version.hpp"
#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::EventKind;
using protocol::Origin;
using protocol::Refusal;
using Events = std::vector<protocol::FrameEvent>;

class RoomSeats : public RoomTest {
 protected:
  const Events& events_of(std::uint64_t tick) { return log_.ticks[tick - 1].frame.events; }
};

TEST_F(RoomSeats, AReservedSeatIsFreeToTheTick) {
  open();
  run(10);
  ASSERT_TRUE(room_->reserve(0, "ada", 30));
  run(29);
  EXPECT_EQ(refusal(join(0)).code, Refusal::kSeatTaken);
  run(1);
  EXPECT_EQ(room_->tick(), 40u);
  EXPECT_FALSE(room_->wants_close(join(0)));
}

TEST_F(RoomSeats, AReservedSeatIsClaimedByItsIdentityOnly) {
  open();
  ASSERT_TRUE(room_->reserve(0, "ada", 100));
  const protocol::Refused refused = refusal(admit(0, Role::kPlayer, "eve"));
  EXPECT_EQ(refused.code, Refusal::kSeatTaken);
  EXPECT_EQ(refused.reason, "seat 0 is reserved up to tick 100");
  EXPECT_EQ(refusal(admit(0, Role::kPlayer, "eve", 0)).code, Refusal::kSeatTaken);
  const PeerId any = admit(protocol::kAnySeat, Role::kPlayer, "bob");
  EXPECT_EQ(room_->seats()[1].holder, any) << "any seat is one that is free";
  const PeerId ada = admit(protocol::kAnySeat, Role::kPlayer, "ada");
  EXPECT_EQ(room_->seats()[0].holder, ada) << "and for her it is her own";
}

TEST_F(RoomSeats, AnIdentityStandsInTheLogAndFakesNoLineOfIt) {
  open();
  (void)admit(0, Role::kPlayer, "ada\nroom arena: client 7 joined");
  const PeerId eve = admit(0, Role::kPlayer, "eve");
  run(1);
  room_->disconnect(admit(1, Role::kPlayer, "bob"));
  const auto said = [&](const std::string& words) {
    return std::ranges::any_of(notices_, [&](const Notice& notice) {
      EXPECT_EQ(notice.text.find('\n'), std::string::npos) << notice.text;
      return notice.text.find(words) != std::string::npos;
    });
  };
  EXPECT_TRUE(said("in seat 0, identity \"ada?room arena: client 7 joined\""));
  EXPECT_TRUE(room_->wants_close(eve) && said("identity \"eve\" refused: kSeatTaken"));
  EXPECT_TRUE(said("joined at tick 1 in seat 1, identity \"bob\""));
  EXPECT_TRUE(said("identity \"bob\" left: "));
}

TEST_F(RoomSeats, WhoComesBackIsNamedByTheIdentityOfItsSeat) {
  open(one_second_to_resume());
  const PeerId first = admit(1, Role::kPlayer, "ada");
  const auto secret = secret_of(first);
  run(1);
  room_->disconnect(first);
  (void)come_back(secret);
  EXPECT_NE(notices_.back().text.find("came back at tick 1 in seat 1, identity \"ada\""),
            std::string::npos)
      << notices_.back().text;
}

TEST_F(RoomSeats, ASeatReservedForNoIdentityIsClaimedByATokenBoundToIt) {
  open();
  ASSERT_TRUE(room_->reserve(1, "", 100));
  EXPECT_EQ(refusal(join(1)).code, Refusal::kSeatTaken);
  const PeerId bound = admit(protocol::kAnySeat, Role::kPlayer, "", 1);
  EXPECT_EQ(room_->seats()[1].holder, bound);
}

TEST_F(RoomSeats, ATokensSeatIsWorthMoreThanAWish) {
  open();
  const PeerId id = admit(0, Role::kPlayer, "", 1);
  EXPECT_EQ(only<protocol::Welcome>(hear(id))[0].seat, 1);
}

TEST_F(RoomSeats, ASpectatorsRoleHasNoSeatWhateverItWishes) {
  open();
  const PeerId id = admit(0, Role::kSpectator);
  EXPECT_EQ(only<protocol::Welcome>(hear(id))[0].seat, protocol::kSpectator);
  say(id, protocol::Input{1, push(1)});
  EXPECT_EQ(refusal(id).reason, "an input of a spectator");
  run(1);
  EXPECT_TRUE(events_of(1).empty());
}

TEST_F(RoomSeats, AGateRefusesNothingThatTheRoomShould) {
  open();
  protocol::Hello other = hello();
  other.solver_version = 99;
  EXPECT_EQ(refusal(room_->admit({other, Role::kPlayer, protocol::kAnySeat, "", ""})).code,
            Refusal::kSolverVersion);
  other = hello();
  other.protocol_version = 1;
  EXPECT_EQ(refusal(room_->admit({other, Role::kPlayer, protocol::kAnySeat, "", ""})).code,
            Refusal::kProtocolVersion);
}

TEST_F(RoomSeats, ARoomsNameIsAsked) {
  RoomOptions options;
  options.name = "blue";
  open_with(options);
  const PeerId id = room_->connect();
  protocol::Hello greeting = hello();
  greeting.room = "red";
  say(id, greeting);
  const protocol::Refused refused = refusal(id);
  EXPECT_EQ(refused.code, Refusal::kNoSuchRoom);
  EXPECT_EQ(refused.reason, "room \"red\", here \"blue\"");
  EXPECT_EQ(only<protocol::Welcome>(hear(join(0)))[0].room, "blue");
}

TEST_F(RoomSeats, WhoIsKickedIsToldWhyAndItIsAnEvent) {
  open();
  const PeerId id = enter(1);
  run(1);
  (void)hear(id);
  ASSERT_TRUE(room_->kick(1, "swearing"));
  const protocol::Refused refused = refusal(id);
  EXPECT_EQ(refused.code, Refusal::kKicked);
  EXPECT_EQ(refused.reason, "swearing");
  run(1);
  EXPECT_EQ(events_of(2), (Events{{EventKind::kKick, 1}}));
  EXPECT_FALSE(room_->kick(1, "again")) << "nobody sits there";
  EXPECT_FALSE(room_->kick(7, "nowhere"));
}

TEST_F(RoomSeats, ALockedRoomIsForAdminsOnly) {
  open();
  const PeerId inside = enter(0);
  room_->lock(true);
  EXPECT_EQ(refusal(join(1)).code, Refusal::kRoomLocked);
  EXPECT_FALSE(room_->wants_close(admit(protocol::kSpectator, Role::kAdmin)));
  EXPECT_FALSE(room_->wants_close(inside));
  room_->lock(false);
  EXPECT_FALSE(room_->wants_close(join(1)));
}

TEST_F(RoomSeats, APausedMatchStandsStillAndGoesOnWithoutHurry) {
  open();
  const PeerId id = enter(0);
  run(10);
  room_->pause("dinner");
  EXPECT_TRUE(room_->paused());
  const std::int64_t before = now_;
  run(50);
  EXPECT_EQ(room_->tick(), 10u);
  EXPECT_GT(now_ - before, 1'000'000'000);
  say(id, protocol::Ping{5});
  EXPECT_EQ(only<protocol::Pong>(hear(id)).size(), 1u) << "clients are heard meanwhile";
  room_->resume();
  room_->advance();
  EXPECT_EQ(room_->tick(), 10u) << "the next tick is as far away as it was";
  run(5);
  EXPECT_EQ(room_->tick(), 15u);
  EXPECT_EQ(room_->statistics().catch_up_ticks, 0u);
}

TEST_F(RoomSeats, APauseIsToldWithItsReasonWhereItHasOne) {
  open();
  const PeerId id = enter(0);
  for (const std::string reason : {"", "dinner"}) {
    const std::string text = "the match stands still" + (reason.empty() ? "" : ": " + reason);
    notices_.clear();
    room_->pause(reason);
    ASSERT_EQ(notices_.size(), 1u);
    EXPECT_EQ(notices_[0].text, text);
    const auto told = only<protocol::RoomNotice>(hear(id));
    ASSERT_EQ(told.size(), 1u);
    EXPECT_EQ(told[0].text, text);
    room_->resume();
    (void)hear(id);
  }
}

TEST_F(RoomSeats, InAPauseNobodyTimesOutAndRatesGoOn) {
  Limits limits;
  limits.messages_per_s = 5;
  open(limits);
  const PeerId id = enter(0);
  run(3);
  room_->pause("dinner");
  now_ += 60'000'000'000;
  run(1);
  EXPECT_FALSE(room_->wants_close(id)) << "it has nothing to say while nothing happens";
  for (int i = 0; i < 40; ++i, now_ += 250'000'000) {
    say(id, protocol::Ping{7});
    run(1);
    ASSERT_EQ(only<protocol::Pong>(hear(id)).size(), 1u) << i;
  }
  now_ += 60'000'000'000;
  const std::int64_t due = room_->next_deadline_ns();
  room_->resume();
  EXPECT_GE(room_->statistics().slowed_ns, 130'000'000'000u) << "and that it stood still is said";
  EXPECT_NE(room_->next_deadline_ns(), due);
  run(5);
  EXPECT_EQ(room_->tick(), 8u);
  EXPECT_FALSE(room_->wants_close(id));
}

TEST_F(RoomSeats, ALostSeatWaitsToTheTickAndThenIsFree) {
  open(one_second_to_resume());
  const PeerId id = enter(0);
  say(id, protocol::Input{1, push(7)});
  say(id, protocol::Input{2, push(8)});
  run(1);
  room_->disconnect(id);
  EXPECT_EQ(refusal(join(0)).code, Refusal::kSeatTaken);
  run(70);
  EXPECT_EQ(events_of(2), (Events{{EventKind::kLost, 0}}));
  EXPECT_EQ(log_.ticks[1].frame.seats[0], (protocol::SeatFrame{Origin::kGiven, push(8)}))
      << "what was said in time counts";
  EXPECT_EQ(log_.ticks[2].frame.seats[0], (protocol::SeatFrame{Origin::kNeutral, {}}));
  std::uint64_t left = 0;
  for (std::uint64_t tick = 3; tick <= 71; ++tick) {
    if (events_of(tick) == Events{{EventKind::kLeave, 0}}) left = tick;
  }
  EXPECT_EQ(left, 62u) << "lost after tick 1, 60 ticks kept, free in the frame after";
  EXPECT_FALSE(room_->wants_close(join(0)));
}

TEST_F(RoomSeats, AResumeTokenBringsTheSameSeatBackAndWorksOnce) {
  open(one_second_to_resume());
  const PeerId first = join(1);
  const auto secret = secret_of(first);
  ASSERT_EQ(secret.size(), protocol::kResumeBytes);
  run(5);
  room_->disconnect(first);
  run(5);
  const PeerId second = come_back(secret);
  const auto welcomes = only<protocol::Welcome>(hear(second));
  ASSERT_EQ(welcomes.size(), 1u);
  EXPECT_EQ(welcomes[0].seat, 1);
  EXPECT_NE(welcomes[0].resume, secret);
  run(1);
  EXPECT_EQ(events_of(6), (Events{{EventKind::kLost, 1}}));
  EXPECT_EQ(events_of(11), (Events{{EventKind::kResume, 1}}));
  say(second, protocol::Input{12, push(3)});  // Shows that it has the new one.
  run(1);
  EXPECT_EQ(log_.ticks[11].frame.seats[1], (protocol::SeatFrame{Origin::kGiven, push(3)}));
  EXPECT_EQ(refusal(come_back(secret)).code, Refusal::kResumeUnknown);
  EXPECT_FALSE(room_->wants_close(second));
  EXPECT_EQ(room_->statistics().resumes, 1u);
}

TEST_F(RoomSeats, AWelcomeThatWasLostOnTheWayLocksNobodyOut) {
  open(one_second_to_resume());
  const PeerId first = join(1);
  const auto secret = secret_of(first);
  room_->disconnect(first);
  const PeerId second = come_back(secret);
  run(1);
  room_->disconnect(second);
  const PeerId third = come_back(secret);
  EXPECT_FALSE(room_->wants_close(third));
  EXPECT_EQ(room_->seats()[1].holder, third);
}

TEST_F(RoomSeats, TheOldConnectionOfAResumedSeatIsFenced) {
  open(one_second_to_resume());
  const PeerId old = join(0);
  const auto secret = secret_of(old);
  say(old, protocol::Input{3, push(33)});
  run(1);
  (void)hear(old);
  const PeerId fresh = come_back(secret);
  const protocol::Refused refused = refusal(old);
  EXPECT_EQ(refused.code, Refusal::kReplaced);
  EXPECT_EQ(refused.reason, "seat 0 was resumed by client " + std::to_string(fresh));
  say(old, protocol::Input{2, push(99)});
  room_->disconnect(old);
  EXPECT_EQ(room_->seats()[0].holder, fresh);
  run(2);
  EXPECT_EQ(events_of(2), (Events{{EventKind::kLost, 0}, {EventKind::kResume, 0}}));
  EXPECT_NE(log_.ticks[1].frame.seats[0].input, push(99)) << "of a fenced connection";
  EXPECT_EQ(log_.ticks[2].frame.seats[0].input, push(33)) << "said in time, before";
}

TEST_F(RoomSeats, WhoCameBackMaySayItsInputsAnew) {
  Limits limits = one_second_to_resume();
  limits.words_per_input_max = 2;
  open(limits);
  const PeerId first = join(0);
  const auto secret = secret_of(first);
  for (const int word : {1, 2}) say(first, protocol::Input{5, push(word)});
  room_->disconnect(first);
  const PeerId second = come_back(secret);
  (void)hear(second);
  for (const int word : {3, 4}) say(second, protocol::Input{5, push(word)});
  EXPECT_FALSE(room_->wants_close(second));
  say(second, protocol::Input{5, push(5)});
  EXPECT_EQ(refusal(second).reason, "3 inputs for tick 5, of at most 2");
}

TEST_F(RoomSeats, WhoCameBackWithItsStateIsSentTheFramesSince) {
  open(one_second_to_resume());
  const PeerId first = join(0);
  Mirror mirror(scene_);
  const auto greeting = hear(first);
  mirror.take(greeting);
  const auto secret = only<protocol::Welcome>(greeting)[0].resume;
  run(20);
  mirror.take(hear(first));
  room_->disconnect(first);
  run(30);
  const std::uint64_t encodes = room_->statistics().encodes;
  const PeerId second = come_back(secret);
  say(second, protocol::Ack{20});
  const auto messages = hear(second);
  EXPECT_EQ(only<protocol::Welcome>(messages)[0].tick, 20u);
  EXPECT_TRUE(only<protocol::SnapshotPart>(messages).empty());
  EXPECT_EQ(only<protocol::InputFrame>(messages).size(), 30u);
  mirror.take(messages);
  EXPECT_EQ(mirror.simulation.digest(), room_->digest());
  EXPECT_EQ(room_->statistics().encodes, encodes);
  run(1);
  mirror.take(hear(second));
  EXPECT_EQ(mirror.simulation.digest(), room_->digest());
}

TEST_F(RoomSeats, WhoseFramesAreGoneIsGivenTheState) {
  Limits limits = one_second_to_resume();
  limits.frames_kept_max = 8;
  limits.keyframe_ticks = 4;
  open(limits);
  const PeerId first = join(0);
  const auto secret = secret_of(first);
  run(10);
  room_->disconnect(first);
  run(30);
  const PeerId second = come_back(secret);
  say(second, protocol::Ack{10});
  const auto messages = hear(second);
  EXPECT_EQ(only<protocol::Welcome>(messages)[0].tick, 40u);
  EXPECT_EQ(only<protocol::SnapshotPart>(messages).size(), 1u);
}

TEST_F(RoomSeats, TokensOfSeatsThatWereLeftMeanNothing) {
  open(one_second_to_resume());
  const PeerId id = join(0);
  const auto secret = secret_of(id);
  say(id, protocol::Bye{"enough"});
  room_->disconnect(id);
  EXPECT_EQ(refusal(come_back(secret)).code, Refusal::kResumeUnknown);
  const PeerId next = join(0);
  EXPECT_EQ(refusal(come_back(secret)).code, Refusal::kResumeUnknown);
  EXPECT_FALSE(room_->wants_close(next));
  EXPECT_EQ(refusal(come_back(std::vector<std::byte>(32))).code, Refusal::kResumeUnknown);
}

TEST_F(RoomSeats, WhoFallsSilentMayComeBack) {
  Limits limits = one_second_to_resume();
  limits.idle = std::chrono::seconds(2);
  open(limits);
  const PeerId id = join(0);
  const auto secret = secret_of(id);
  for (int tick = 0; tick < 140; ++tick) {
    run(1);
    if (!room_->wants_close(id)) (void)hear(id);
  }
  EXPECT_EQ(refusal(id).code, Refusal::kTooSlow);
  EXPECT_FALSE(room_->wants_close(come_back(secret)));
}

}  // namespace
}  // namespace cycloid::server
