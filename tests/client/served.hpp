#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <stop_token>
#include <utility>

#include "server/serve.hpp"

namespace cycloid::client {

/// Of anything that a test waits for.
inline constexpr std::chrono::seconds kDeadline{30};

/// A real server on its own thread and a port of its own, stopped with the test.
class Served {
 public:
  explicit Served(server::ServeOptions options) {
    options.catch_signals = false;
    options.stop_on_log_error = true;
    report_ = std::async(std::launch::async, [this, options = std::move(options)] {
      return server::serve(
          options, [this](std::uint16_t port) { port_.set_value(port); }, stop_.get_token());
    });
  }
  ~Served() {
    stop_.request_stop();
    if (report_.valid()) report_.wait();
  }
  std::uint16_t port() {
    auto port = port_.get_future();
    if (port.wait_for(kDeadline) == std::future_status::ready) return port.get();
    ADD_FAILURE() << "the server does not listen";
    return 1;
  }
  server::ServeReport report() {
    if (report_.wait_for(kDeadline) != std::future_status::ready) {
      ADD_FAILURE() << "the server did not end in time";
      stop_.request_stop();
    }
    return report_.get();
  }

 private:
  std::promise<std::uint16_t> port_;
  std::stop_source stop_;
  std::future<server::ServeReport> report_;
};

}  // namespace cycloid::client
