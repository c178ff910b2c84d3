#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "client/visit.hpp"
#include "protocol/log/scan.hpp"
#include "scenes/catalogue.hpp"
#include "tests/cli/program.hpp"

namespace cycloid {
namespace {

using namespace std::chrono_literals;

/// For a server to let its players in, and for a player to notice that it is gone.
constexpr auto kPatience = 20s;
constexpr const char* kSceneName = "half-pipe";

int wanted_kills() {
  const char* wanted = std::getenv("CYCLOID_SERVER_KILLS");
  return wanted != nullptr ? std::max(1, std::atoi(wanted)) : 12;
}

protocol::Log read_log_file(const std::string& file) {
  const std::string text = cli::read_text(file);
  return protocol::read_log(std::as_bytes(std::span(text)));
}

/// Where the log and what a client heard contradict each other; "" where they do not.
/// @param waited_for  Whether each tick was on the disk before any client heard of it.
std::string contradiction(const protocol::Log& log, const std::vector<protocol::InputFrame>& heard,
                          bool waited_for) {
  if (log.state != protocol::LogState::kOpen && log.state != protocol::LogState::kTorn) {
    return "the log is neither open nor torn: " + log.reason;
  }
  for (const protocol::InputFrame& frame : heard) {
    const std::string tick = "tick " + std::to_string(frame.tick);
    if (frame.tick > log.ticks.size()) {
      if (waited_for) return tick + " was heard and is not in the log";
      continue;
    }
    const protocol::InputFrame& kept = log.ticks[frame.tick - 1].frame;
    if (kept != frame) return tick + " is another in the log";
  }
  return "";
}

/// One who plays by the scene's script and keeps every frame that it hears.
class Player {
 public:
  explicit Player(std::uint16_t port) {
    client::JoinOptions options;
    options.port = port;
    options.scene = *scenes::find(kSceneName).scene;
    options.on_frame = [this](const protocol::InputFrame& frame) { heard_.push_back(frame); };
    visit_ = std::make_unique<client::Visit>(std::move(options));
  }
  void poll() { visit_->poll(1ms); }
  bool over() const { return visit_->over(); }
  client::JoinReport report() const { return visit_->report(); }
  const std::vector<protocol::InputFrame>& heard() const { return heard_; }

 private:
  std::vector<protocol::InputFrame> heard_;
  std::unique_ptr<client::Visit> visit_;
};

/// A server that keeps a log, two who play on it, and its death.
class ServerKill : public testing::Test {
 protected:
  void begin(const std::string& log_sync, const std::string& tick_rate) {
    players_.clear();
    folder_ = std::make_unique<cli::Folder>();
    server_ = std::make_unique<cli::Background>(
        std::vector<std::string>{"serve", kSceneName, "--port", "0", "--log", log_file(),
                                 "--log-sync", log_sync, "--tick-rate", tick_rate});
    const std::string address = server_->wait_for("listening on ");
    const auto port =
        static_cast<std::uint16_t>(std::stoul("0" + address.substr(address.rfind(':') + 1)));
    for (int i = 0; i < 2; ++i) players_.push_back(std::make_unique<Player>(port));
  }
  std::string log_file() const { return folder_->file("match.cylog"); }

  template <class Condition>
  bool poll_until(Condition condition, std::chrono::nanoseconds at_most) {
    const auto end = std::chrono::steady_clock::now() + at_most;
    while (!condition() && std::chrono::steady_clock::now() < end) {
      for (const auto& player : players_) player->poll();
    }
    return condition();
  }
  bool all_heard_something() const {
    return std::ranges::all_of(players_, [](const auto& p) { return !p->heard().empty(); });
  }
  bool all_over() const {
    return std::ranges::all_of(players_, [](const auto& p) { return p->over(); });
  }

  std::unique_ptr<cli::Folder> folder_;
  std::unique_ptr<cli::Background> server_;
  std::vector<std::unique_ptr<Player>> players_;
};

/// kill -9 of a whole server at any moment of a match: what its log says is what every client has
/// heard, a replay makes the same digests, and in the mode that waits for the disk nobody has heard
/// of a tick that is not in it.
TEST_F(ServerKill, LeavesNoWrongRecord) {
  std::mt19937_64 random(5);
  const int kills = wanted_kills();
  const std::vector<std::string> modes = {"tick", "interval", "none"};
  std::uint64_t logged = 0;
  std::uint64_t heard = 0;
  int torn = 0;
  for (int kill = 0; kill < kills; ++kill) {
    const std::string& mode = modes[static_cast<std::size_t>(kill) % modes.size()];
    begin(mode, std::to_string(60 + random() % 440));
    const bool while_they_join = kill % 8 == 7;
    if (!while_they_join) {
      ASSERT_TRUE(poll_until([&] { return all_heard_something(); }, kPatience)) << kill;
    }
    const auto lives = std::chrono::microseconds(random() % (while_they_join ? 10'000 : 300'000));
    (void)poll_until([] { return false; }, lives);
    ASSERT_FALSE(all_over()) << kill << ": " << players_[0]->report().reason;
    server_->kill_now();
    ASSERT_TRUE(poll_until([&] { return all_over(); }, kPatience)) << kill;

    const protocol::Log log = read_log_file(log_file());
    for (const auto& player : players_) {
      ASSERT_EQ(contradiction(log, player->heard(), mode == "tick"), "") << mode << ", " << kill;
      ASSERT_EQ(player->report().progress.mismatches, 0u) << kill;
      heard += player->heard().size();
    }
    const cli::Ran verified = cli::run_program({"verify", "--allow-open", log_file()});
    ASSERT_EQ(verified.exit, 0) << kill << ": " << verified.out << verified.err;
    logged += log.ticks.size();
    torn += log.state == protocol::LogState::kTorn ? 1 : 0;
  }
  std::printf("%d kills, %llu ticks in logs, %llu frames heard, %d logs torn\n", kills,
              static_cast<unsigned long long>(logged), static_cast<unsigned long long>(heard),
              torn);
  EXPECT_GT(logged, static_cast<std::uint64_t>(kills));
}

/// The check itself: a log that says another thing than was heard, or less.
TEST_F(ServerKill, SeesARecordThatIsNotWhatWasHeard) {
  begin("tick", "240");
  ASSERT_TRUE(poll_until([&] { return players_[0]->heard().size() > 20; }, kPatience));
  server_->kill_now();
  protocol::Log log = read_log_file(log_file());
  const std::vector<protocol::InputFrame> heard = players_[0]->heard();
  ASSERT_EQ(contradiction(log, heard, true), "");
  const std::uint64_t last = heard.back().tick;
  log.ticks[last - 1].frame.seats[0].input.axes[0] ^= 1;
  EXPECT_EQ(contradiction(log, heard, true),
            "tick " + std::to_string(last) + " is another in the log");
  log.ticks.resize(last - 1);
  EXPECT_EQ(contradiction(log, heard, false), "");
  EXPECT_EQ(contradiction(log, heard, true),
            "tick " + std::to_string(last) + " was heard and is not in the log");
}

}  // namespace
}  // namespace cycloid
