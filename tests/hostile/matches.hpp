#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocol/crc32c.hpp"
#include "protocol/little_endian.hpp"
#include "protocol/log_format.hpp"
#include "scenes/catalogue.hpp"
#include "scenes/scene.hpp"

namespace cycloid::hostile {

/// A recorded match: its log, where each of its records ends (the header first, the footer last),
/// and the digest after every tick.
struct Match {
  scenes::Scene scene;
  protocol::Bytes log;
  std::vector<std::size_t> ends;
  std::vector<std::uint64_t> digests;
};

inline scenes::Scene catalogue_scene(const std::string& name) {
  scenes::Loaded loaded = scenes::find(name);
  if (!loaded.scene) throw std::logic_error(name + ": " + loaded.mistakes.at(0).reason);
  return std::move(*loaded.scene);
}

/// Plays a scene by its script, but for buttons and axes that change in every tick.
inline Match played(const std::string& name, std::uint64_t ticks) {
  Match match;
  match.scene = catalogue_scene(name);
  scenes::Simulation simulation = std::move(scenes::Simulation::create(match.scene).value());
  protocol::LogHeader header;
  header.scene_digest = scenes::scene_digest(match.scene);
  header.salt = 0x5a17;
  header.scene_name = match.scene.name;
  header.scene = scenes::to_binary(match.scene);
  protocol::LogEncoder encoder(header, match.log);
  match.ends.push_back(match.log.size());
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    protocol::LogTick record;
    record.frame.tick = tick;
    std::vector<scenes::SeatInput> inputs;
    for (int seat = 0; seat < simulation.seats(); ++seat) {
      scenes::SeatInput input = scenes::scripted_input(match.scene, seat, tick);
      input.axes[0] = static_cast<std::int16_t>(8000 * tick);
      input.buttons = static_cast<std::uint16_t>(tick);
      inputs.push_back(input);
      record.frame.seats.push_back({protocol::Origin::kGiven, input});
    }
    if (!simulation.step(inputs).ok()) throw std::logic_error(name + " does not step");
    record.digest = simulation.digest();
    match.digests.push_back(record.digest);
    encoder.tick(record, match.log);
    match.ends.push_back(match.log.size());
  }
  encoder.footer({ticks, match.digests.back()}, match.log);
  match.ends.push_back(match.log.size());
  return match;
}

inline constexpr std::size_t kSceneDigestPlace = 24;  ///< Of a log's header: docs/protocol.md.
inline constexpr std::size_t kSaltPlace = 32;

/// Makes every check of a log fit again, as a writer who means harm would. The records are taken to
/// lie where they lay in the original.
inline void refit_checks(const std::vector<std::size_t>& ends, protocol::Bytes& log) {
  const std::span<const std::byte> bytes(log);
  std::uint32_t check = protocol::crc32c(bytes.first(ends[0] - 4));
  solver::store_little(check, log.data() + ends[0] - 4);
  for (std::size_t i = 1; i < ends.size(); ++i) {
    std::vector<std::byte> chain(bytes.begin() + kSaltPlace, bytes.begin() + kSaltPlace + 8);
    protocol::append_little(check, chain);
    const auto record = bytes.subspan(ends[i - 1], ends[i] - ends[i - 1] - 4);
    check = protocol::crc32c(record, protocol::crc32c(chain));
    solver::store_little(check, log.data() + ends[i] - 4);
  }
}

}  // namespace cycloid::hostile
