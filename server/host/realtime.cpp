#include "server/host/realtime.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <cerrno>
#include <system_error>

namespace cycloid::server {
namespace {

/// Above the kernel's default of threaded interrupts nothing of the network would come in.
constexpr int kRealtimePriority = 20;

std::string reason() {
  return std::generic_category().message(errno);
}

}  // namespace

std::string make_thread_realtime() {
  sched_param parameters{};
  parameters.sched_priority = kRealtimePriority;
  // Not for threads that this one starts, such as the writer of a branched log.
  if (::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) == 0) return "";
  return "SCHED_FIFO: " + reason();
}

std::string lock_memory() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_MEMLOCK, &limit) != 0) return "RLIMIT_MEMLOCK: " + reason();
  // Under a limit the lock of future memory turns into allocations that fail, later.
  if (limit.rlim_cur != RLIM_INFINITY) {
    return "mlockall: the limit of locked memory is " + std::to_string(limit.rlim_cur) + " bytes";
  }
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return "";
  return "mlockall: " + reason();
}

}  // namespace cycloid::server
