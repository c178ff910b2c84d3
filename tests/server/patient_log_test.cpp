#include "server/host/patient_log.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <future>
#include <sstream>
#include <string>

#include "tests/server/host_fixture.hpp"

namespace cycloid::server {
namespace {

/// A pipe that holds a few dozen lines.
class SmallPipe {
 public:
  SmallPipe() {
    EXPECT_EQ(::pipe2(ends_.data(), O_CLOEXEC), 0);
    EXPECT_GE(::fcntl(ends_[1], F_SETPIPE_SZ, 4096), 4096);
  }
  SmallPipe(const SmallPipe&) = delete;
  SmallPipe& operator=(const SmallPipe&) = delete;
  ~SmallPipe() {
    close_reader();
    close_writer();
  }
  int writer() const { return ends_[1]; }
  void close_reader() { close_end(ends_[0]); }
  void close_writer() { close_end(ends_[1]); }
  /// Up to where `end` stands, or the writer was closed.
  std::string read_to(const std::string& end) const {
    std::string text;
    std::array<char, 4096> part;
    while (end.empty() || text.find(end) == std::string::npos) {
      const ssize_t bytes = ::read(ends_[0], part.data(), part.size());
      if (bytes <= 0) break;
      text.append(part.data(), static_cast<std::size_t>(bytes));
    }
    return text;
  }
  std::string read_all() const { return read_to(""); }

 private:
  static void close_end(int& end) {
    if (end >= 0) (void)::close(end);
    end = -1;
  }

  std::array<int, 2> ends_{-1, -1};
};

constexpr int kLines = 10000;

void write_lines(spdlog::logger& logger) {
  for (int i = 0; i < kLines; ++i) logger.info("the line {}", i);
}

TEST(PatientLog, AReaderThatStopsReadingIsNotWaitedForNorAtTheEnd) {
  SmallPipe pipe;
  auto logger = log_to(pipe.writer());
  auto written = std::async(std::launch::async, [&] {
    write_lines(*logger);
    logger.reset();
  });
  EXPECT_EQ(written.wait_for(kHostPatience), std::future_status::ready);
  pipe.close_reader();  // Ends a wait that was not to be.
}

// Which says that there is room as long as there is any, and then waits for that of a whole line.
TEST(PatientLog, NorIsATerminal) {
  const int reader = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  ASSERT_EQ(::grantpt(reader), 0);
  ASSERT_EQ(::unlockpt(reader), 0);
  const int writer = ::open(::ptsname(reader), O_WRONLY | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(writer, 0);
  auto logger = log_to(writer);
  auto written = std::async(std::launch::async, [&] {
    write_lines(*logger);
    logger.reset();
  });
  EXPECT_EQ(written.wait_for(kHostPatience), std::future_status::ready);
  (void)::close(reader);
  (void)::close(writer);
}

TEST(PatientLog, WhatIsLeftOutIsCounted) {
  SmallPipe pipe;
  auto logger = log_to(pipe.writer());
  write_lines(*logger);
  std::istringstream lines(pipe.read_to("the line " + std::to_string(kLines - 1) + "\n"));
  logger.reset();
  int whole = 0;
  int left_out = 0;
  std::string last;
  for (std::string line; std::getline(lines, line); last = line) {
    const std::size_t count = line.find(" lines are left out here");
    if (count == std::string::npos) {
      ++whole;
    } else {
      left_out += std::stoi(line.substr(line.rfind(' ', count - 1)));
    }
  }
  EXPECT_GT(left_out, 0);
  EXPECT_EQ(whole + left_out, kLines);
  EXPECT_NE(last.find("the line " + std::to_string(kLines - 1)), std::string::npos) << last;
}

TEST(PatientLog, WhatIsWrittenBeforeTheEndArrives) {
  SmallPipe pipe;
  auto read = std::async(std::launch::async, [&] { return pipe.read_all(); });
  auto logger = log_to(pipe.writer());
  for (int i = 0; i < 3; ++i) logger->warn(std::string(5000, 'x'));  // More than a pipe's whole.
  logger.reset();
  pipe.close_writer();
  const std::string text = read.get();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_EQ(std::count(text.begin(), text.end(), 'x'), 3 * 5000);
}

TEST(PatientLog, AReaderThatIsGoneIsNoReasonToWait) {
  SmallPipe pipe;
  const auto ignored = std::signal(SIGPIPE, SIG_IGN);
  pipe.close_reader();
  auto logger = log_to(pipe.writer());
  write_lines(*logger);
  logger.reset();
  (void)std::signal(SIGPIPE, ignored);
}

}  // namespace
}  // namespace cycloid::server
