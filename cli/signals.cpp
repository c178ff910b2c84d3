#include "cli/signals.hpp"

#include <csignal>

namespace cycloid::cli {
namespace {

volatile std::sig_atomic_t stop_signals = 0;

}  // namespace

void catch_stop_signals() {
  const auto note = [](int) { stop_signals = 1; };
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
}

bool stop_requested() {
  return stop_signals != 0;
}

}  // namespace cycloid::cli
