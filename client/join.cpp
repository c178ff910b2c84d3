#include "client/join.hpp"

#include "client/net/connection.hpp"
#include "client/visit.hpp"

namespace cycloid::client {

const char* end_name(End end) {
  switch (end) {
    case End::kTicks:
      return "ticks";
    case End::kBye:
      return "bye";
    case End::kStopped:
      return "stopped";
    case End::kRefused:
      return "refused";
    case End::kDisconnected:
      return "disconnected";
    case End::kFailed:
      return "failed";
  }
  return "unknown";
}

JoinReport join(const JoinOptions& options) {
  Visit visit(options);
  while (!visit.over()) visit.poll(Connection::kPollInterval);
  return visit.report();
}

}  // namespace cycloid::client
