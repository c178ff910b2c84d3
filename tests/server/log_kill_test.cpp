#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "server/log/log_writer.hpp"
#include "tests/server/log_disks.hpp"

namespace cycloid::server {
namespace {

/// What a writer that is killed has said, in memory that outlives it.
struct Said {
  std::atomic<bool> begun{false};
  std::atomic<std::uint64_t> returned{0};  ///< The last tick whose call has returned.
};

class LogKill : public testing::Test {
 protected:
  LogKill()
      : said_(*new (::mmap(nullptr, sizeof(Said), PROT_READ | PROT_WRITE,
                           MAP_SHARED | MAP_ANONYMOUS, -1, 0)) Said),
        folder_(testing::TempDir() + "cycloid-kill-" + std::to_string(::getpid())) {}
  ~LogKill() override {
    std::filesystem::remove_all(folder_);
    ::munmap(&said_, sizeof(Said));
  }

  /// Writes until it is killed; turns to a second file on its way.
  [[noreturn]] void write_for_ever(LogSync sync, std::uint64_t rotate_at) {
    LogWriterOptions options;
    options.path = folder_ + "/a.cylog";
    options.sync = sync;
    options.interval = std::chrono::milliseconds(2);
    options.keyframes = {20, 100};
    protocol::LogHeader header;
    header.salt = rotate_at;
    LogWriter writer(options, header);
    said_.begun = true;
    for (std::uint64_t tick = 1;; ++tick) {
      if (tick == rotate_at) (void)writer.rotate(folder_ + "/b.cylog");
      writer.tick(numbered_tick(tick));
      said_.returned = tick;
      if (writer.wants_keyframe(tick))
        writer.keyframe(tick, numbered_tick(tick).digest, numbered_state(tick));
      if (sync != LogSync::kEveryTick && tick % 64 == 0) ::usleep(100);
    }
  }

  protocol::Log read(const std::string& name) const {
    std::ifstream stream(folder_ + name, std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
    return protocol::read_log(std::as_bytes(std::span(text)));
  }

  Said& said_;
  std::string folder_;
};

int wanted_kills() {
  const char* wanted = std::getenv("CYCLOID_LOG_KILLS");
  return wanted != nullptr ? std::max(1, std::atoi(wanted)) : 50;
}

/// kill -9 at any moment: what is there is a good prefix and never a wrong record, and in the mode
/// that waits for the disk it holds every tick whose call had returned.
TEST_F(LogKill, LeavesAGoodPrefix) {
  std::mt19937_64 random(11);
  std::uint64_t ticks = 0;
  int torn = 0;
  int rotated = 0;
  const int kills = wanted_kills();
  for (int kill = 0; kill < kills; ++kill) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    said_.begun = false;
    said_.returned = 0;
    const LogSync sync = kill % 2 == 0 ? LogSync::kEveryTick : LogSync::kInterval;
    const std::uint64_t rotate_at = 1 + random() % 60;
    const pid_t writer = ::fork();
    ASSERT_GE(writer, 0);
    if (writer == 0) write_for_ever(sync, rotate_at);
    while (!said_.begun) ::usleep(100);
    ::usleep(static_cast<useconds_t>(random() % 15000));
    ASSERT_EQ(::kill(writer, SIGKILL), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(writer, &status, 0), writer);
    ASSERT_TRUE(WIFSIGNALED(status));

    const protocol::Log first = read("/a.cylog");
    ASSERT_EQ(wrong_in(first), "") << kill;
    std::uint64_t last = first.last_tick;
    if (std::filesystem::exists(folder_ + "/b.cylog")) {
      const protocol::Log second = read("/b.cylog");
      ASSERT_EQ(wrong_in(second), "") << kill;
      ASSERT_EQ(first.state, protocol::LogState::kComplete) << first.reason;
      ASSERT_EQ(second.header.branch_tick, first.last_tick);
      last = second.last_tick;
      ++rotated;
    }
    if (sync == LogSync::kEveryTick) {
      ASSERT_GE(last, said_.returned) << kill;
    }
    torn += first.state == protocol::LogState::kTorn ? 1 : 0;
    ticks += last;
  }
  std::printf("%d kills, %llu ticks, %d torn, %d in the second file\n", kills,
              static_cast<unsigned long long>(ticks), torn, rotated);
  EXPECT_GT(ticks, static_cast<std::uint64_t>(kills));
}

}  // namespace
}  // namespace cycloid::server
