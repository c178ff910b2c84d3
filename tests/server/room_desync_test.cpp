#include <gtest/gtest.h>

#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::Refusal;

/// Says back what it was asked, and asks for a state.
class TestInquiry final : public DesyncInquiry {
 public:
  InquiryAnswer on_mismatch(const Mismatch& mismatch, const RoomEvidence& evidence) override {
    mismatches.push_back(mismatch);
    const auto state = evidence.state_at_or_before(mismatch.tick);
    EXPECT_NE(state, nullptr);
    state_tick = state == nullptr ? 0 : state->tick();
    frames_since = 0;
    for (std::uint64_t tick = state_tick + 1; tick <= evidence.tick(); ++tick) {
      EXPECT_NE(evidence.frame_at(tick), nullptr);
      EXPECT_TRUE(evidence.digest_at(tick));
      ++frames_since;
    }
    return {{protocol::StateWanted{mismatch.tick}}, ""};
  }
  InquiryAnswer on_tick_digests(PeerId, const protocol::TickDigests& said,
                                const RoomEvidence&) override {
    digests.push_back(said);
    return {};
  }
  InquiryAnswer on_state_part(PeerId, const protocol::StatePart& part,
                              const RoomEvidence&) override {
    bytes += part.bytes.size();
    return {{}, part.offset == 0 ? "" : "a part that nobody asked for"};
  }
  void on_gone(PeerId peer) override { gone.push_back(peer); }
  void on_break(const std::string& why, const RoomEvidence& evidence) override {
    breaks.push_back(why);
    frames_at_break = 0;
    for (std::uint64_t tick = 1; evidence.frame_at(tick) != nullptr; ++tick) ++frames_at_break;
  }
  void on_digest(PeerId peer, std::uint64_t tick, std::uint64_t) override {
    votes.emplace_back(peer, tick);
  }
  std::vector<std::pair<PeerId, protocol::ServerMessage>> take_messages(
      const RoomEvidence&) override {
    return std::exchange(messages, {});
  }

  std::vector<Mismatch> mismatches;
  std::vector<protocol::TickDigests> digests;
  std::vector<PeerId> gone;
  std::vector<std::pair<PeerId, protocol::ServerMessage>> messages;
  std::uint64_t state_tick = 0;
  std::uint64_t frames_since = 0;
  std::vector<std::string> breaks;
  std::uint64_t frames_at_break = 0;
  std::vector<std::pair<PeerId, std::uint64_t>> votes;
  std::size_t bytes = 0;
};

class RoomDesync : public RoomTest {};

TEST_F(RoomDesync, IsAnsweredWithTheExactStateAtOnce) {
  open();
  const PeerId bad = enter(0);
  const PeerId good = enter(1);
  run(65);
  (void)hear(bad);
  (void)hear(good);
  say(good, protocol::Digest{60, log_.ticks[59].digest});
  EXPECT_FALSE(room_->has_output(good));
  say(bad, protocol::Digest{60, 0xbad});
  EXPECT_EQ(room_->statistics().desyncs, 1u);
  say(bad, protocol::Digest{61, 0xbad});
  EXPECT_EQ(room_->statistics().desyncs, 1u) << "said before it could have the state";
  Mirror mirror(scene_);
  mirror.take(hear(bad));
  EXPECT_EQ(mirror.states, 1u);
  EXPECT_EQ(mirror.simulation.tick(), 65u);

  say(bad, protocol::Digest{60, 0xbad});
  EXPECT_FALSE(room_->has_output(bad));
  run(60);
  mirror.take(hear(bad));
  EXPECT_EQ(mirror.simulation.digest(), room_->digest());

  say(bad, protocol::Digest{120, 0xbad});
  mirror.take(hear(bad));
  EXPECT_EQ(mirror.states, 2u);
  EXPECT_EQ(room_->statistics().desyncs, 2u);
  EXPECT_EQ(count(Notice::Kind::kDesync), 1) << "said once, counted always";
  EXPECT_FALSE(room_->wants_close(bad));
  EXPECT_FALSE(room_->wants_close(good));
}

/// Anybody could make up such a digest: it does not show that the welcome has come.
TEST_F(RoomDesync, EndsNoGraceOfTheResumeTokenBefore) {
  resumable_ = true;
  open();
  const PeerId first = join(0);
  const auto used = secret_of(first);
  const auto say_digest = [&](PeerId id, std::uint64_t flip) {
    (void)hear(id);
    run(60);
    (void)hear(id);
    say(id, protocol::Digest{room_->tick(), room_->digest() ^ flip});
  };
  const PeerId second = come_back(used);
  say_digest(second, 1);
  EXPECT_EQ(room_->statistics().desyncs, 1u);
  const PeerId third = come_back(used);
  EXPECT_FALSE(room_->wants_close(third));
  say_digest(third, 0);
  EXPECT_EQ(refusal(come_back(used)).code, Refusal::kResumeUnknown);
}

TEST_F(RoomDesync, MoreThanThreeInFiveMinutesAreTheEnd) {
  open();
  const PeerId id = enter(0);
  for (int desync = 0; desync < 3; ++desync) {
    run(60);
    (void)hear(id);
    say(id, protocol::Digest{room_->tick(), 0xbad});
    (void)hear(id);
    EXPECT_FALSE(room_->wants_close(id));
  }
  run(60);
  (void)hear(id);
  say(id, protocol::Digest{room_->tick(), 0xbad});
  const protocol::Refused refused = refusal(id);
  EXPECT_EQ(refused.code, Refusal::kResyncLimit);
  EXPECT_EQ(refused.reason, "desynced more than 3 times in 300 s");
}

TEST_F(RoomDesync, AfterFiveMinutesAClientMayDesyncAgain) {
  open();
  const PeerId id = enter(0);
  for (int desync = 0; desync < 6; ++desync) {
    for (int second = 0; second < 110; ++second) {
      run(60);
      (void)hear(id);
      say(id, protocol::Ping{1});
    }
    (void)hear(id);
    say(id, protocol::Digest{room_->tick(), 0xbad});
    (void)hear(id);
  }
  EXPECT_FALSE(room_->wants_close(id));
  EXPECT_EQ(room_->statistics().desyncs, 6u);
}

TEST_F(RoomDesync, IsInquiredIntoWithTheTicksSinceTheKeyframe) {
  TestInquiry inquiry;
  inquiry_ = &inquiry;
  open();
  const PeerId id = enter(0);
  run(100);
  (void)hear(id);
  say(id, protocol::Digest{90, 0xbad});
  ASSERT_EQ(inquiry.mismatches.size(), 1u);
  EXPECT_EQ(inquiry.mismatches[0].tick, 90u);
  EXPECT_EQ(inquiry.mismatches[0].theirs, 0xbadu);
  EXPECT_EQ(inquiry.mismatches[0].ours, log_.ticks[89].digest);
  EXPECT_EQ(inquiry.mismatches[0].name, "tester");
  EXPECT_EQ(inquiry.state_tick, 60u);
  EXPECT_EQ(inquiry.frames_since, 40u);
  const auto messages = hear(id);
  ASSERT_EQ(only<protocol::StateWanted>(messages).size(), 1u);
  EXPECT_EQ(only<protocol::SnapshotPart>(messages).size(), 1u) << "without waiting for the answer";

  say(id, protocol::TickDigests{61, {1, 2, 3}});
  ASSERT_EQ(inquiry.digests.size(), 1u);
  say(id, protocol::StatePart{90, 6000, 0, std::vector<std::byte>(3000)});
  EXPECT_EQ(inquiry.bytes, 3000u);
  inquiry.messages.push_back({id, protocol::RoomNotice{protocol::NoticeKind::kReport, 90, 0, "x"}});
  run(1);
  EXPECT_EQ(only<protocol::RoomNotice>(hear(id)).size(), 1u);
  say(id, protocol::StatePart{90, 6000, 3000, std::vector<std::byte>(3000)});
  EXPECT_EQ(refusal(id).reason, "a part that nobody asked for");
  EXPECT_EQ(inquiry.gone, std::vector<PeerId>{id});
}

/// It is asked for once, so it may come twice at the most, and a little beside.
TEST_F(RoomDesync, OnlySoMuchOfAStateIsFreeOfTheRates) {
  TestInquiry inquiry;
  inquiry_ = &inquiry;
  Limits limits;
  limits.bytes_per_s = 4096;
  open(limits);
  const PeerId id = enter(0);
  run(65);
  (void)hear(id);
  say(id, protocol::Digest{60, 0xbad});
  (void)hear(id);
  const protocol::StatePart part{60, 6000, 0, std::vector<std::byte>(3000)};
  for (int i = 0; i < 60 && !room_->wants_close(id); ++i) say(id, part);
  EXPECT_EQ(refusal(id).code, Refusal::kRateLimited);
  std::vector<std::byte> state;
  room_->encode_state(state);
  const std::size_t free_bytes = 2 * state.size() + 65536;
  EXPECT_GT(inquiry.bytes, free_bytes - 2 * part.bytes.size());
  EXPECT_LT(inquiry.bytes, free_bytes + 2 * limits.bytes_per_s);
}

TEST_F(RoomDesync, OnlyDigestsThatAllAreAskedForAreVotes) {
  TestInquiry inquiry;
  inquiry_ = &inquiry;
  open();
  const PeerId id = enter(0);
  run(65);
  (void)hear(id);
  run(65);
  (void)hear(id);
  for (std::uint64_t tick = 50; tick <= 130; ++tick) {
    say(id, protocol::Digest{tick, log_.ticks[tick - 1].digest});
    if (tick % 60 == 0) run(1);  // More than 64 messages are for the next tick.
  }
  EXPECT_EQ(inquiry.votes, (std::vector<std::pair<PeerId, std::uint64_t>>{{id, 60}, {id, 120}}));
}

TEST_F(RoomDesync, InquiriesHearOfARewindAndOfTheEndWhileAllIsKept) {
  TestInquiry inquiry;
  inquiry_ = &inquiry;
  open();
  run(100);
  ASSERT_TRUE(room_->rewind(40));
  ASSERT_EQ(inquiry.breaks.size(), 1u);
  EXPECT_EQ(inquiry.frames_at_break, 100u) << "of the branch that ends here";
  EXPECT_FALSE(room_->rewind(90)) << "it is not made yet, and nothing was broken off";
  run(10);
  room_->drain("over");
  ASSERT_EQ(inquiry.breaks.size(), 2u);
  EXPECT_EQ(inquiry.frames_at_break, 50u);
}

TEST_F(RoomDesync, EvidenceKnowsTheStateAtTheBeginningAndThoseFromATickOn) {
  class Looker final : public DesyncInquiry {
   public:
    InquiryAnswer on_mismatch(const Mismatch&, const RoomEvidence& evidence) override {
      start = evidence.digest_at(0);
      from = evidence.state_from(61);
      none = evidence.state_from(121) == nullptr;
      return {};
    }
    InquiryAnswer on_tick_digests(PeerId, const protocol::TickDigests&,
                                  const RoomEvidence&) override {
      return {};
    }
    InquiryAnswer on_state_part(PeerId, const protocol::StatePart&, const RoomEvidence&) override {
      return {};
    }
    void on_gone(PeerId) override {}
    void on_break(const std::string&, const RoomEvidence&) override {}
    std::optional<std::uint64_t> start;
    std::shared_ptr<const ExactState> from;
    bool none = false;
  } looker;
  inquiry_ = &looker;
  open();
  const std::uint64_t digest = room_->digest();
  const PeerId id = enter(0);
  run(65);
  (void)hear(id);
  run(60);
  (void)hear(id);
  say(id, protocol::Digest{120, 0xbad});
  EXPECT_EQ(looker.start, digest);
  ASSERT_NE(looker.from, nullptr);
  EXPECT_EQ(looker.from->tick(), 120u);
  EXPECT_TRUE(looker.none);
}

}  // namespace
}  // namespace cycloid::server
