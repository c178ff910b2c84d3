#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/server/admission_fixture.hpp"
#include "tests/server/host_fixture.hpp"

namespace cycloid::server {
namespace {

using namespace std::chrono_literals;
using protocol::Refusal;

/// A token for "arena" that is good now.
AdmissionToken token_of_today(std::uint64_t number) {
  AdmissionToken token = arena_token(number);
  token.not_before_unix_s = std::time(nullptr) - 10;
  token.expires_unix_s = std::time(nullptr) + 600;
  return token;
}

class HostAdmission : public testing::Test {
 protected:
  protocol::Hello hello(const std::string& room) const {
    protocol::Hello hello;
    hello.scene_digest = scenes::scene_digest(two_seat_scene());
    hello.room = room;
    return hello;
  }
  protocol::Hello shown(std::uint64_t number, const SigningKey& key = issuer_key()) const {
    protocol::Hello hello = this->hello("arena");
    hello.token = sign_token(token_of_today(number), key);
    return hello;
  }
  HostOptions guarded() {
    HostOptions options = quiet_host(lines_);
    options.gate.tokens = TokenPolicy::kRequired;
    options.gate.keys = {issuer_key().public_key()};
    options.rooms.push_back({"arena", two_seat_settings()});
    return options;
  }
  /// Its refusal, or nothing where it was let in.
  std::optional<Refusal> refused(const protocol::Hello& hello) {
    HostPeer peer(server_->port());
    peer.send(hello);
    const auto refused = peer.wait_for<protocol::Refused>();
    return refused ? std::optional(refused->code) : std::nullopt;
  }
  std::unique_ptr<HostPeer> let_in(const protocol::Hello& hello) {
    auto peer = std::make_unique<HostPeer>(server_->port());
    peer->send(hello);
    EXPECT_TRUE(peer->wait_for<protocol::Welcome>());
    return peer;
  }
  std::string close() { return last_words(server_, lines_); }

  HostLines lines_;
  std::optional<RunningHost> server_;
};

TEST_F(HostAdmission, ASecretOfNoRoomMakesNone) {
  server_.emplace(guarded());
  protocol::Hello stranger = hello("duel:1");
  stranger.resume.assign(protocol::kResumeBytes, std::byte{7});
  EXPECT_EQ(refused(stranger), Refusal::kNoSuchRoom);
  EXPECT_EQ(server_->host().meters().rooms_made.get(), 1u);
  EXPECT_EQ(server_->host().rooms().size(), 1u);
}

TEST_F(HostAdmission, ATokenIsStillGoodAfterTheRoomHadNoFreeSeat) {
  server_.emplace(guarded());
  const auto first = let_in(shown(1));
  const auto second = let_in(shown(2));
  EXPECT_EQ(refused(shown(3)), Refusal::kRoomFull);
  first->send(protocol::Bye{"enough"});
  ASSERT_TRUE(eventually([&] {
    HostPeer third(server_->port());
    third.send(shown(3));
    if (third.wait_for<protocol::Welcome>()) return true;
    std::this_thread::sleep_for(10ms);
    return false;
  }));
}

TEST_F(HostAdmission, ATokenIsStillGoodAfterTheRoomHadNoPlace) {
  HostOptions options = guarded();
  options.limits.room.connections_max = 1;
  server_.emplace(std::move(options));
  auto first = let_in(shown(1));
  EXPECT_EQ(refused(shown(2)), Refusal::kRoomFull);
  first.reset();
  ASSERT_TRUE(eventually([&] {
    HostPeer second(server_->port());
    second.send(shown(2));
    if (second.wait_for<protocol::Welcome>()) return true;
    std::this_thread::sleep_for(10ms);
    return false;
  }));
}

TEST_F(HostAdmission, ATokenIsStillGoodAfterTheRoomCouldNotBeMade) {
  const std::filesystem::path folder =
      testing::TempDir() + "/cycloid-unmade-" + std::to_string(::getpid());
  std::filesystem::remove_all(folder);
  HostOptions options = guarded();
  options.templates["duel"].settings.log_directory = folder;
  server_.emplace(std::move(options));
  AdmissionToken token = token_of_today(1);
  token.room = "duel:1";
  protocol::Hello first = hello("duel:1");
  first.token = sign_token(token, issuer_key());
  EXPECT_EQ(refused(first), Refusal::kNoSuchRoom);
  std::filesystem::create_directories(folder);
  const auto peer = let_in(first);
  EXPECT_EQ(refused(first), Refusal::kTokenUsed);
  (void)close();
  std::filesystem::remove_all(folder);
}

TEST_F(HostAdmission, NewKeysHoldForTokensFromThenOn) {
  server_.emplace(guarded());
  const SigningKey other = SigningKey::generate(seeded_random(2));
  EXPECT_EQ(refused(shown(1, other)), Refusal::kTokenInvalid);
  server_->host().set_token_keys({other.public_key()});
  EXPECT_EQ(refused(shown(2)), Refusal::kTokenInvalid);
  const auto peer = let_in(shown(3, other));
  ASSERT_TRUE(peer->wait_for<protocol::InputFrame>());
}

TEST_F(HostAdmission, WhoIsRefusedByARoomFillsNoLog) {
  HostOptions options = quiet_host(lines_);
  options.rooms.push_back({"arena", two_seat_settings()});
  server_.emplace(std::move(options));
  protocol::Hello wrong = hello("arena");
  wrong.scene_digest ^= 1;
  constexpr int kTimes = 150;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kTimes; ++i) EXPECT_EQ(refused(wrong), Refusal::kSceneDigest);
  std::this_thread::sleep_for(500ms);  // Until there may be a line again.
  EXPECT_EQ(refused(wrong), Refusal::kSceneDigest);
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  const std::string said = close();
  EXPECT_NE(said.find("lines like this left out before"), std::string::npos) << said;
  const double most = kClientLines.burst + kClientLines.per_s * passed.count() + 5;
  EXPECT_LE(static_cast<double>(std::ranges::count(said, '\n')), most);
}

TEST_F(HostAdmission, WhoIsTurnedAwayBehindTheGateIsOnRecord) {
  HostOptions options = quiet_host(lines_);
  const std::string folder = testing::TempDir() + "/no/such/folder";
  options.templates["duel"].settings.log_directory = folder;
  server_.emplace(std::move(options));
  HostPeer peer(server_->port());
  peer.send(hello("duel:1"));
  const auto word = peer.wait_for<protocol::Refused>();
  ASSERT_TRUE(word);
  EXPECT_EQ(word->code, Refusal::kNoSuchRoom);
  EXPECT_EQ(word->reason, "the server cannot make this room") << "paths are nobody's business";
  EXPECT_EQ(server_->host().meters().rooms_made.get(), 0u);
  const auto code = static_cast<std::size_t>(Refusal::kNoSuchRoom);
  EXPECT_EQ(server_->host().meters().refusals[code].get(), 1u);
  const std::string said = close();
  EXPECT_NE(said.find("refused 127.0.0.1: "), std::string::npos) << said;
  EXPECT_NE(said.find("room duel:1 cannot be made: " + folder), std::string::npos) << said;
}

/// Whose files are made when the test says so.
class SlowDisk final : public ScriptedDisk {
 public:
  explicit SlowDisk(const std::atomic<bool>& waits) : waits_(waits) {}
  int create(const std::string& path, int& file) override {
    ++asked;
    while (waits_) std::this_thread::sleep_for(1ms);
    return ScriptedDisk::create(path, file);
  }
  std::atomic<int> asked{0};

 private:
  const std::atomic<bool>& waits_;
};

class HostThatMakesARoom : public HostAdmission {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "/cycloid-making-" + std::to_string(::getpid());
    std::filesystem::create_directories(folder_);
    HostOptions options = quiet_host(lines_);
    options.templates["duel"].settings.log_directory = folder_;
    disk_ = std::make_shared<SlowDisk>(waits_);
    options.disk = disk_;
    server_.emplace(std::move(options));
    server_->host().make_room("duel:1", "duel",
                              [this](const ActResult& made) { made_ = made.ok(); });
    ASSERT_TRUE(eventually([&] { return disk_->asked > 0; }));
  }
  void TearDown() override {
    waits_ = false;
    (void)close();
    std::filesystem::remove_all(folder_);
  }

  std::string folder_;
  std::atomic<bool> waits_{true};
  std::atomic<bool> made_{false};
  std::shared_ptr<SlowDisk> disk_;
};

TEST_F(HostThatMakesARoom, ForAnAdminLetsThoseInWhoCameMeanwhile) {
  HostPeer early(server_->port());
  early.send(hello("duel:1"));
  ASSERT_TRUE(eventually([&] { return server_->host().meters().accepted.get() == 1; }));
  ASSERT_TRUE(eventually([&] { return server_->host().meters().pending.get() == 0; }));
  waits_ = false;
  EXPECT_TRUE(early.wait_for<protocol::Welcome>());
  EXPECT_TRUE(eventually([&] { return made_.load(); })) << "the admin is answered behind them";
}

TEST_F(HostThatMakesARoom, GivesItTheLimitsThatHoldWhenItIsMade) {
  HostLimits limits;
  limits.room.connections_max = 1;
  server_->host().set_limits(limits);
  waits_ = false;
  ASSERT_TRUE(eventually([&] { return made_.load(); }));
  const auto first = let_in(hello("duel:1"));
  EXPECT_EQ(refused(hello("duel:1")), Refusal::kRoomFull);
}

}  // namespace
}  // namespace cycloid::server
