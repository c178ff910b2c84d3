#ifdef CYCLOID_NETWORK

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "tests/cli/program.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

std::string port_of(const std::string& address) {
  return address.substr(address.rfind(':') + 1);
}

TEST(JoinFlags, ThatAreWrongAreUsageAndNamed) {
  const Folder folder;
  const std::string no_token = folder.file("no.token");
  write_text(no_token, "not a token!\n");
  struct Case {
    std::string words;
    std::vector<std::string> flags;
  };
  const Case cases[] = {
      {"--predict", {"--predict", "65"}},
      {"--predict: a snapshot client", {"--predict", "5", "--snapshot"}},
      {"--profile", {"--profile", "raw"}},
      {"--room: longer than 64 bytes", {"--room", std::string(65, 'a')}},
      {"--name: longer than 64 bytes", {"--name", std::string(65, 'a')}},
      {"--token: ", {"--token", no_token}},
      {"--tls-fingerprint: \"abc\"", {"--tls-fingerprint", "abc"}},
      {"--tls-ca: " + folder.file("nowhere.pem") + ": no certificates in PEM",
       {"--tls-ca", folder.file("nowhere.pem")}},
  };
  for (const Case& wrong : cases) {
    std::vector<std::string> command = {"join", "127.0.0.1:1", "half-pipe"};
    command.insert(command.end(), wrong.flags.begin(), wrong.flags.end());
    const Ran ran = run_program(command);
    EXPECT_EQ(ran.exit, 2) << wrong.words;
    EXPECT_THAT(ran.err, HasSubstr(wrong.words));
  }
}

TEST(JoinAddress, ThatIsNoneIsUsageAndIsNotLookedUp) {
  for (const char* address : {"localhost", "localhost:", ":7000", "localhost:0", "localhost:65536",
                              "localhost:7000:3", "localhost:7x", "::1:7000"}) {
    const Ran ran = run_program({"join", address, "half-pipe"});
    EXPECT_EQ(ran.exit, 2) << address;
    EXPECT_THAT(ran.err, HasSubstr(std::string("HOST:PORT: not one, nor [IPV6]:PORT: ") + address));
  }
  const Ran nobody = run_program({"join", "[::1]:1", "half-pipe"});
  EXPECT_EQ(nobody.exit, 5) << "nobody listens there";
}

TEST(JoinFlags, SayHowTheMatchIsPlayed) {
  Background server({"serve", "half-pipe", "--port", "0", "--digest-every", "5", "--json"});
  const std::string address = server.wait_for("listening on ");
  ASSERT_NE(address, "");
  const auto join = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"join", address, "half-pipe", "--json"});
    return run_program(flags);
  };
  const nlohmann::json predicted =
      join({"--room", "main", "--predict", "8", "--ticks", "60"}).json();
  EXPECT_EQ(predicted["exit"], 0) << predicted;
  EXPECT_EQ(predicted["seat"], 0);
  EXPECT_EQ(predicted["mismatches"], 0);
  EXPECT_GT(predicted["digests_compared"], 5);

  const nlohmann::json exact = join({"--snapshot", "--ticks", "60"}).json();
  const nlohmann::json quantised =
      join({"--snapshot", "--profile", "quantised", "--ticks", "60"}).json();
  EXPECT_EQ(exact["exit"], 0) << exact;
  EXPECT_EQ(quantised["exit"], 0) << quantised;
  EXPECT_GT(exact["snapshots"], 5);
  EXPECT_GT(quantised["snapshots"], 5);
  EXPECT_LT(quantised["bytes_in"], exact["bytes_in"]);

  const Ran nobody = join({"--room", "nobody"});
  EXPECT_EQ(nobody.exit, 2);
  EXPECT_THAT(nobody.err, HasSubstr("there is no room \"nobody\""));
  const Ran encrypted = join({"--tls"});
  EXPECT_EQ(encrypted.exit, 5);
  EXPECT_THAT(encrypted.err, HasSubstr("does the server speak TLS here?"));
}

TEST(JoinFlags, WhereAllSeatsAreTakenOneIsToldOfTheSpectators) {
  Background server({"serve", "bouncing", "--port", "0", "--json"});
  const std::string address = server.wait_for("listening on ");
  ASSERT_NE(address, "");
  const Background player({"join", address, "bouncing"});
  ASSERT_NE(server.wait_for("joined at tick "), "");
  const Ran second = run_program({"join", address, "bouncing", "--json"});
  EXPECT_EQ(second.exit, 5);
  EXPECT_EQ(second.json()["reason"], "1 seats taken, of 1");
  EXPECT_THAT(second.err, HasSubstr("1 seats taken, of 1; to look on without a seat: "
                                    "--seat spectator\n"));
  EXPECT_EQ(run_program({"join", address, "bouncing", "--seat", "spectator", "--ticks", "5"}).exit,
            0);
}

TEST(JoinFlags, ReconnectComesBackToAServerThatWasKilled) {
  auto server = std::make_unique<Background>(
      std::vector<std::string>{"serve", "half-pipe", "--port", "0", "--json"});
  const std::string address = server->wait_for("listening on ");
  ASSERT_NE(address, "");
  Background client(
      {"join", address, "half-pipe", "--reconnect", "30", "--ticks", "240", "--json"});
  ASSERT_NE(server->wait_for("joined at tick "), "");
  // The line comes before the welcome is written, and this one is welcomed behind it.
  ASSERT_EQ(run_program({"join", address, "half-pipe", "--seat", "spectator", "--ticks", "5"}).exit,
            0);
  server.reset();  // Killed.
  server = std::make_unique<Background>(
      std::vector<std::string>{"serve", "half-pipe", "--port", port_of(address), "--json"});
  ASSERT_NE(server->wait_for("listening on "), "");
  const Ran ran = client.wait();
  EXPECT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.json()["end"], "ticks");
  EXPECT_EQ(ran.json()["reconnects"], 1);
}

/// A client whose build rounds the friction of contacts otherwise, in a real match: it is told
/// apart, and the report's tick is made again by both builds.
TEST(WrongFrictionPlayer, IsReportedAndTheReportIsRepeatedWithTheServersBuildInTheRight) {
  const Folder folder;
  const std::string reports = folder.file("reports");
  std::filesystem::create_directory(reports);
  const std::string config = folder.file("serve.toml");
  // Made by the client's join, however late that is, so that the wall has not come to rest then.
  write_text(config, "[server]\nport = 0\n[operation]\nport = 0\ndesync_directory = \"" + reports +
                         "\"\n[limits]\ndigest_ticks = 5\n[template.t]\nscene = \"wall\"\n"
                         "tick_rate_hz = 20.0\non_first_join = true\nempty_ttl_s = 60\n");
  Background server({"serve", "--config", config, "--json"});
  const std::string address = server.wait_for("listening on ");
  ASSERT_NE(address, "");
  const Ran played = run_other(
      places::wrong_friction_program(),
      {"join", address, "wall", "--room", "t:1", "--seat", "spectator", "--ticks", "60", "--json"});
  EXPECT_EQ(played.exit, 1) << played.err;
  EXPECT_GT(played.json()["mismatches"], 0) << played.out;
  EXPECT_GT(played.json()["resyncs"], 0);
  const std::string file = server.wait_for("; report ");
  ASSERT_NE(file, "") << "no report";

  const Ran shown = run_program({"desync", "show", file});
  EXPECT_EQ(shown.exit, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("tangent_impulse"));
  EXPECT_THAT(shown.out, HasSubstr("wrong: the client"));
  const Ran here = run_program({"desync", "repeat", file, "--json"});
  EXPECT_EQ(here.exit, 0) << here.err;
  EXPECT_EQ(here.json()["agrees_with"], "server");
  EXPECT_EQ(here.json()["digest"], here.json()["server"]);
  const Ran there =
      run_other(places::wrong_friction_program(), {"desync", "repeat", file, "--json"});
  EXPECT_EQ(there.exit, 1) << there.err;
  EXPECT_EQ(there.json()["agrees_with"], "client") << there.out;
  EXPECT_EQ(there.json()["from_tick"].get<int>() + 1, there.json()["tick"].get<int>());
  const Ran text = run_program({"desync", "repeat", file});
  EXPECT_THAT(text.out, HasSubstr("this build agrees with the server\n"));

  std::filesystem::remove(std::filesystem::path(file).replace_extension(".cylog"));
  EXPECT_EQ(run_program({"desync", "repeat", file}).exit, 5) << "its log is gone";
  write_text(file, "{}");
  EXPECT_EQ(run_program({"desync", "repeat", file}).exit, 3);
}

}  // namespace
}  // namespace cycloid::cli

#endif  // CYCLOID_NETWORK
