#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tests/client/authority.hpp"

namespace cycloid::client {

template <class Message>
std::vector<Message> all_of(const Outbox& outbox) {
  std::vector<Message> found;
  for (const protocol::ClientMessage& message : outbox) {
    if (const auto* wanted = std::get_if<Message>(&message)) found.push_back(*wanted);
  }
  return found;
}

/// A follower of either mode beside the authority that feeds it.
template <class Kind>
class Fed : public testing::Test {
 protected:
  Fed() : scene_(Authority::scene()), authority_(scene_), follower_(make(), options()) {}

  scenes::Simulation make() { return std::move(scenes::Simulation::create(scene_).value()); }
  FollowerOptions options() {
    FollowerOptions options;
    options.scene_digest = scenes::scene_digest(scene_);
    options.name = "test";
    options.input = [this](int seat, std::uint64_t tick) {
      return scenes::scripted_input(scene_, seat, tick);
    };
    return options;
  }
  void feed(const protocol::ServerMessage& message) { follower_.receive(message, outbox_); }
  void start(std::int32_t seat = 0) {
    feed(authority_.welcome(seat));
    feed(authority_.snapshot());
    ASSERT_EQ(follower_.progress().phase, Phase::kRunning) << follower_.progress().reason;
  }
  void expect_failed(const std::string& words) {
    EXPECT_EQ(follower_.progress().phase, Phase::kFailed);
    EXPECT_NE(follower_.progress().reason.find(words), std::string::npos)
        << follower_.progress().reason;
  }

  scenes::Scene scene_;
  Authority authority_;
  Kind follower_;
  Outbox outbox_;
};

}  // namespace cycloid::client
