#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/codec.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::server {

/// Encoded once, sent to many.
using Shared = std::shared_ptr<const protocol::Bytes>;

/// The exact state after one tick.
class ExactState {
 public:
  ExactState(std::uint64_t tick, std::uint64_t digest, protocol::Bytes bytes)
      : tick_(tick), digest_(digest), bytes_(std::move(bytes)) {}

  std::uint64_t tick() const { return tick_; }
  std::uint64_t digest() const { return digest_; }
  const protocol::Bytes& bytes() const { return bytes_; }  ///< World::encode.
  std::size_t parts() const;                               ///< Messages that it travels in.
  /// The SnapshotPart of this place. @pre i < parts().
  Shared part(std::size_t i) const;

 private:
  std::uint64_t tick_;
  std::uint64_t digest_;
  protocol::Bytes bytes_;
  mutable std::vector<Shared> parts_;  ///< Made when first asked for, and then for all clients.
};

/// Encodes the state of a tick when somebody first asks for it, and once.
class ExactStates {
 public:
  /// @pre `digest` is that of the simulation as it is.
  std::shared_ptr<const ExactState> of(const scenes::Simulation& simulation, std::uint64_t digest);
  /// The state has become another one without a tick, by a rewind.
  void forget() { last_.reset(); }
  std::uint64_t encodes() const { return encodes_; }

 private:
  std::shared_ptr<const ExactState> last_;
  std::uint64_t encodes_ = 0;
};

}  // namespace cycloid::server
