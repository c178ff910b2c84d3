#include "server/host/realtime.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <string>
#include <thread>

namespace cycloid::server {
namespace {

/// Whether the system lets a thread of this process have real time, asked without the code under
/// test.
bool may_be_realtime() {
  bool may = false;
  std::thread([&] {
    sched_param parameters{};
    parameters.sched_priority = 1;
    may = ::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
  }).join();
  return may;
}

// Where the system refuses it, as without the right to it, nothing changes and the reason is told.
TEST(Realtime, IsOfTheThreadAloneAndNotOfThoseItStarts) {
  std::string refused;
  int own = 0;
  int of_another = 0;
  std::thread([&] {
    refused = make_thread_realtime();
    own = ::sched_getscheduler(0);
    std::thread([&] { of_another = ::sched_getscheduler(0); }).join();
  }).join();
  const bool may = may_be_realtime();
  EXPECT_EQ(refused.empty(), may) << refused;
  EXPECT_EQ(refused.starts_with("SCHED_FIFO: "), !may) << refused;
  EXPECT_EQ(own & ~SCHED_RESET_ON_FORK, may ? SCHED_FIFO : SCHED_OTHER);
  EXPECT_EQ(of_another, SCHED_OTHER);
}

}  // namespace
}  // namespace cycloid::server
