#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <future>

#include "tests/server/config_fixture.hpp"
#include "tests/server/http_fixture.hpp"

namespace cycloid::server {
namespace {

using namespace std::chrono_literals;

const std::string kPorts = "[server]\nport = 0\n[operation]\nport = 0\n";

/// With an admin, who reloads and is answered when it is done.
class ConfigReloadTest : public testing::Test {
 protected:
  ConfigReloadTest() { token_.write(std::string(kAdminToken) + "\n"); }

  std::string admin() const { return "[admin]\ntoken_file = \"" + token_.path() + "\"\n"; }
  void serve(const std::string& head = "") {
    file_.write(kPorts + head + admin() + kConfigRooms);
    server_.emplace(file_);
  }
  Answer reload(const std::string& text) {
    file_.write(text);
    return reload();
  }
  Answer reload() { return post("/admin/reload"); }
  Answer post(const std::string& path) { return http(server_->at().operation_port, "POST", path); }
  std::unique_ptr<HostPeer> greeted(const std::string& room) {
    auto peer = std::make_unique<HostPeer>(server_->at().port);
    peer->greet(room);
    return peer;
  }
  /// How its greeting was refused, or nothing.
  std::optional<protocol::Refusal> refused(const std::string& room) {
    const auto peer = greeted(room);
    const auto refused = peer->wait_for<protocol::Refused>();
    return refused ? std::optional(refused->code) : std::nullopt;
  }
  std::string lines() {
    EXPECT_TRUE(server_->stop().good);
    return server_->lines();
  }

  ConfigFile file_{"reload"};
  ConfigFile token_{"reload-token"};
  std::optional<Configured> server_;
};

TEST_F(ConfigReloadTest, TakesLimitsAndRefusesAPortByName) {
  serve();
  const auto first = greeted("duel:1");
  ASSERT_TRUE(first->wait_for<protocol::Welcome>());
  EXPECT_EQ(reload("[server]\nport = 4711\n[operation]\nport = 0\n[limits]\nrooms = 1\n" + admin() +
                   kConfigRooms)
                .status,
            409);
  const auto second = greeted("duel:2");  // The old limit still holds: nothing was taken.
  ASSERT_TRUE(second->wait_for<protocol::Welcome>());
  EXPECT_EQ(reload("[server\n").status, 422);
  EXPECT_EQ(reload(kPorts + "[limits]\nrooms = 1\n" + admin() + kConfigRooms).status, 200);
  EXPECT_EQ(refused("duel:3"), protocol::Refusal::kRoomFull);
  first->hang_up();
  second->hang_up();
  const std::string said = lines();
  EXPECT_NE(said.find("cannot change while the server runs: server.port"), std::string::npos)
      << said;
  EXPECT_NE(said.find("not TOML"), std::string::npos) << said;
  EXPECT_NE(said.find("reloaded " + file_.path()), std::string::npos) << said;
}

TEST_F(ConfigReloadTest, ComesWithSighupToo) {
  serve();
  const auto peer = greeted("arena");
  ASSERT_TRUE(peer->wait_for<protocol::Welcome>());  // From then on signals are caught.
  file_.write(kPorts + "[limits]\nrooms = 1\n" + admin() + kConfigRooms);
  ASSERT_EQ(::kill(::getpid(), SIGHUP), 0);
  int tries = 0;
  EXPECT_TRUE(eventually([&] {  // Until then each makes a room.
    return !greeted("duel:" + std::to_string(++tries))->wait_for<protocol::Welcome>();
  }));
  peer->hang_up();
  EXPECT_NE(lines().find("reloaded " + file_.path()), std::string::npos);
}

/// What is at the path when the signal comes may be anything; the matches go on.
TEST_F(ConfigReloadTest, AFolderInThePlaceOfTheFileEndsNoMatch) {
  serve();
  const auto peer = greeted("arena");
  ASSERT_TRUE(peer->wait_for<protocol::Welcome>());
  std::filesystem::remove(file_.path());
  std::filesystem::create_directory(file_.path());
  ASSERT_EQ(::kill(::getpid(), SIGHUP), 0);
  Answer answer;
  EXPECT_TRUE(eventually([&] {  // While the signal's is under way the admin's is refused.
    answer = reload();
    return answer.status != 409;
  }));
  EXPECT_EQ(answer.status, 422);
  EXPECT_NE(answer.body.find("cannot be read"), std::string::npos) << answer.body;
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(peer->wait_for<protocol::InputFrame>());
  peer->hang_up();
  const std::string said = lines();
  const std::string refusal = "not reloaded, nothing is changed";
  const std::size_t first = said.find(refusal);
  ASSERT_NE(first, std::string::npos) << said;
  EXPECT_NE(said.find(refusal, first + 1), std::string::npos)
      << "the signal and the admin: " << said;
}

TEST_F(ConfigReloadTest, TakesTheBoundsOfTheGate) {
  serve();
  const auto first = greeted("arena");
  ASSERT_TRUE(first->wait_for<protocol::Welcome>());
  const std::string bounds = "[limits]\nconnections = 1\n";
  ASSERT_EQ(reload(kPorts + bounds + admin() + kConfigRooms).status, 200);
  EXPECT_EQ(refused("arena"), protocol::Refusal::kRateLimited);
  ASSERT_TRUE(first->wait_for<protocol::InputFrame>());  // Who is in stays.
  ASSERT_EQ(reload(kPorts + admin() + kConfigRooms).status, 200);
  const auto second = greeted("arena");
  EXPECT_TRUE(second->wait_for<protocol::Welcome>());
}

TEST_F(ConfigReloadTest, ADrainLastsAsLongAsTheFileSaysNow) {
  serve();
  const auto peer = greeted("arena");
  ASSERT_TRUE(peer->wait_for<protocol::Welcome>());
  const std::string longer = "[server]\nport = 0\ndrain_s = 70\n[operation]\nport = 0\n";
  ASSERT_EQ(reload(longer + admin() + kConfigRooms).status, 200);
  EXPECT_EQ(post("/admin/rooms/arena/drain").status, 200);
  const auto notice = peer->wait_for<protocol::RoomNotice>();
  ASSERT_TRUE(notice);
  EXPECT_EQ(notice->value, 70'000u);
}

/// Such as of a disk that does not answer: neither the matches nor another reload wait for it.
TEST(ConfiguredServer, WhoseFilesDoNotAnswerRefusesTheNextReload) {
  const ConfigFile file("reload-hangs");
  const ConfigFile token("reload-hangs-token");
  token.write(std::string(kAdminToken) + "\n");
  file.write(kPorts + "[admin]\ntoken_file = \"" + token.path() + "\"\n" + kConfigRooms);
  std::promise<void> answers;
  std::atomic<bool> asked{false};
  Configured server(file, [&, answered = answers.get_future().share()](const std::string& name) {
    if (asked.exchange(true)) return load_for_test(name);
    answered.wait();
    return load_for_test(name);
  });
  const auto reload = [&] { return http(server.at().operation_port, "POST", "/admin/reload"); };
  auto first = std::async(std::launch::async, reload);
  EXPECT_TRUE(eventually([&] { return asked.load(); }));
  const Answer second = reload();
  EXPECT_EQ(second.status, 409);
  EXPECT_NE(second.body.find("a reload is under way"), std::string::npos) << second.body;
  answers.set_value();
  EXPECT_EQ(first.get().status, 200);
  EXPECT_EQ(reload().status, 200);
  EXPECT_TRUE(server.stop().good);
}

TEST(ConfiguredServer, ThatCannotHaveItsOperationPortBeginsNoLog) {
  const ConfigFile file("port-taken");
  const std::filesystem::path folder = file.path() + "-logs";
  std::filesystem::create_directories(folder);
  asio::io_context io;
  const asio::ip::tcp::acceptor taken(io, {asio::ip::address_v4::loopback(), 0});
  const std::string port = std::to_string(taken.local_endpoint().port());
  file.write("[server]\nport = 0\n[operation]\nport = " + port +
             "\n[template.duel]\nscene = \"two-seats\"\nlog_directory = \"" + folder.string() +
             "\"\n[[room]]\nname = \"arena\"\ntemplate = \"duel\"\n");
  HostLines lines;
  ConfiguredServer server;
  const ConfigResult read = read_config_file(file.path(), load_for_test);
  ASSERT_TRUE(read.config) << config_mistakes_text(file.path(), read.mistakes);
  server.config = *read.config;
  server.config.host.logger = lines.logger();
  std::stop_source stop;
  stop.request_stop();  // Or, if it could have the port, it would run for ever.
  EXPECT_THROW((void)run_configured(server, {}, stop.get_token()), std::system_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace cycloid::server
