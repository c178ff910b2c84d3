#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "cli/sim/host.hpp"
#include "cli/sim/network.hpp"
#include "cli/sim/settings.hpp"

namespace cycloid::sim {

/// A peer that does not keep the rules, on connection after connection, each time in another way.
///
/// A stranger never says a hello that a room can accept, so nothing that it does may show; a
/// troublemaker says one, and then breaks every rule there is.
class Hostile {
 public:
  enum class Kind : std::uint8_t { kStranger, kTroublemaker };

  Hostile(const Settings& settings, const scenes::Scene& scene, Kind kind, std::size_t room,
          Random random, Host& host, Chronicle& chronicle);

  void step();
  /// It goes away for good.
  void calm();

 private:
  void dial();
  void prepare_stranger();
  void prepare_troublemaker();
  std::vector<std::byte> bad_token();
  void say(const protocol::ClientMessage& message);
  void say_garbage(std::size_t bytes);
  void make_trouble();

  const Settings* settings_;
  Kind kind_;
  std::size_t room_;
  Random random_;
  Host* host_;
  Chronicle* chronicle_;
  std::uint64_t scene_digest_ = 0;
  std::shared_ptr<Wire> wire_;
  protocol::Bytes unsent_;
  std::size_t drip_bytes_ = 0;  ///< Said at a time; 0: all at once.
  std::int64_t dial_at_ns_ = 0;
  std::int64_t gone_at_ns_ = 0;
  std::int64_t next_ns_ = 0;
  std::uint64_t trouble_ = 0;
  bool reads_ = true;
  bool calm_ = false;
};

}  // namespace cycloid::sim
