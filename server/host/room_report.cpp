#include "server/host/room_report.hpp"

namespace cycloid::server {

const char* end_name(End end) {
  switch (end) {
    case End::kDrained:
      return "drained";
    case End::kTicks:
      return "ticks";
    case End::kFaulted:
      return "faulted";
    case End::kLogError:
      return "log error";
  }
  return "unknown";
}

}  // namespace cycloid::server
