#include "server/host/realtime.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <thread>

namespace cycloid::server {
namespace {

TEST(Realtime, IsNotInheritedByThreadsThatAThreadStarts) {
  std::string refused;
  int own = 0;
  int of_another = 0;
  std::thread([&] {
    refused = make_thread_realtime();
    own = ::sched_getscheduler(0);
    std::thread([&] { of_another = ::sched_getscheduler(0); }).join();
  }).join();
  if (!refused.empty()) GTEST_SKIP() << refused;
  EXPECT_EQ(own & ~SCHED_RESET_ON_FORK, SCHED_FIFO);
  EXPECT_EQ(of_another, SCHED_OTHER);
}

}  // namespace
}  // namespace cycloid::server
