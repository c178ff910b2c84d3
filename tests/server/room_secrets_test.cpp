#include <gtest/gtest.h>

#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::Refusal;

/// What brings a seat back, and to whom.
class RoomSecrets : public RoomTest {};

TEST_F(RoomSecrets, TokensOfSeatsThatWereGivenUpMeanNothing) {
  for (const bool kicked : {true, false}) {
    open(one_second_to_resume());
    const PeerId id = join(0);
    const auto secret = secret_of(id);
    run(1);
    room_->disconnect(id);
    if (kicked) {
      ASSERT_TRUE(room_->kick(0, "swearing"));
    } else {
      run(70);
    }
    EXPECT_EQ(refusal(come_back(secret)).code, Refusal::kResumeUnknown) << kicked;
  }
}

TEST_F(RoomSecrets, AResumeTokenIsOfItsIdentityAlone) {
  open(one_second_to_resume());
  const PeerId id = admit(0, Role::kPlayer, "ada");
  protocol::Hello greeting = hello();
  greeting.resume = secret_of(id);
  room_->disconnect(id);
  const auto come_back_as = [&](const std::string& identity) {
    return room_->admit({greeting, Role::kPlayer, protocol::kAnySeat, identity, "192.0.2.1"});
  };
  EXPECT_EQ(refusal(come_back_as("eve")).code, Refusal::kResumeUnknown);
  EXPECT_FALSE(room_->wants_close(come_back_as("ada")));
}

TEST_F(RoomSecrets, WhatIsSaidBeforeTheWelcomeHasLeftProvesNoSecret) {
  open(one_second_to_resume());
  const PeerId first = join(1);
  const auto secret = secret_of(first);
  room_->disconnect(first);
  const PeerId second = come_back(secret);
  say(second, protocol::Input{2, push(3)});
  run(1);
  room_->disconnect(second);
  EXPECT_FALSE(room_->wants_close(come_back(secret)));
}

TEST_F(RoomSecrets, AReservationLastsAsLongWhereTheMatchGoesBack) {
  open();
  run(20);
  ASSERT_TRUE(room_->reserve(0, "ada", 10));
  ASSERT_TRUE(room_->rewind(5));
  run(9);
  EXPECT_EQ(refusal(join(0)).code, Refusal::kSeatTaken);
  run(1);
  EXPECT_FALSE(room_->wants_close(join(0)));
}

}  // namespace
}  // namespace cycloid::server
