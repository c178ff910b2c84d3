#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "client/visit.hpp"
#include "tests/client/authority.hpp"

namespace cycloid::client {
namespace {

JoinOptions good_options() {
  JoinOptions options;
  options.port = 1;  // Nobody listens there, and nobody is asked.
  options.scene = Authority::scene();
  return options;
}

TEST(JoinMistakes, EndAVisitAtOnceAndAreNamed) {
  struct Case {
    const char* reason;
    void (*change)(JoinOptions&);
  };
  const Case cases[] = {
      {"host: empty", [](auto& options) { options.host.clear(); }},
      {"port: not 1 to 65535", [](auto& options) { options.port = 0; }},
      {"mode: none that there is", [](auto& options) { options.mode = protocol::Mode{9}; }},
      {"profile: none that there is",
       [](auto& options) { options.profile = protocol::Profile{0}; }},
      {"seat: not a seat, -1 or -2", [](auto& options) { options.seat_wish = -3; }},
      {"predict_ticks: over 64", [](auto& options) { options.predict_ticks = 1000; }},
      {"predict_ticks: a snapshot client predicts nothing",
       [](auto& options) {
         options.mode = protocol::Mode::kSnapshot;
         options.predict_ticks = 1;
       }},
      {"workers: not 1 to 64", [](auto& options) { options.workers = 0; }},
      {"workers: not 1 to 64", [](auto& options) { options.workers = 65; }},
      {"name: longer than 64 bytes", [](auto& options) { options.name.assign(65, 'a'); }},
      {"room: longer than 64 bytes", [](auto& options) { options.room.assign(65, 'a'); }},
      {"token: longer than 512 bytes", [](auto& options) { options.token.resize(513); }},
      {"resume: not 32 bytes", [](auto& options) { options.resume.resize(1); }},
  };
  for (const Case& wrong : cases) {
    JoinOptions options = good_options();
    wrong.change(options);
    const Visit visit(options);
    EXPECT_TRUE(visit.over()) << wrong.reason;
    EXPECT_EQ(visit.follower(), nullptr) << wrong.reason;
    EXPECT_EQ(visit.report().end, End::kFailed);
    EXPECT_EQ(visit.report().reason, wrong.reason);
  }
  EXPECT_EQ(mistake_of(good_options()), "");
}

TEST(JoinMistakes, OfASceneSayWhere) {
  JoinOptions options = good_options();
  options.scene.bodies.at(1).position[1] = 1.0e9f;
  const Visit visit(options);
  const std::string reason = visit.report().reason;
  EXPECT_TRUE(visit.over());
  EXPECT_EQ(visit.report().end, End::kFailed);
  EXPECT_TRUE(reason.starts_with("the scene cannot run: /bodies/1/position: ")) << reason;
}

}  // namespace
}  // namespace cycloid::client
