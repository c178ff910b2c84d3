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
/// and the digest after every tick. All of it lies in one block of the log.
struct Match {
  scenes::Scene scene;
  protocol::Bytes log;
  std::vector<std::size_t> ends;
  std::vector<std::size_t> ticks_until;  ///< Whole ticks up to each end.
  std::vector<std::size_t> checks;       ///< Ends of all that has a check: also head and chunks.
  std::vector<std::uint64_t> digests;
};

/// The ends of the header, of the heads of blocks and of every chunk.
inline std::vector<std::size_t> check_places(const protocol::Bytes& log) {
  const protocol::LogSummary summary = protocol::scan_log(log);
  const std::size_t header = summary.start.header_bytes;
  std::vector<std::size_t> ends = {header};
  protocol::ChunkReader reader(log, summary.header.salt, header, header, summary.start.check);
  protocol::LogChunk chunk;
  while (reader.next(chunk) == protocol::ChunkReader::Found::kChunk) {
    if ((chunk.at - header) % protocol::kLogBlockBytes == protocol::kBlockHeadBytes)
      ends.push_back(chunk.at);
    ends.push_back(reader.at());
  }
  return ends;
}

inline scenes::Scene catalogue_scene(const std::string& name) {
  scenes::Loaded loaded = scenes::find(name);
  if (!loaded.scene) throw std::logic_error(name + ": " + loaded.mistakes.at(0).reason);
  return std::move(*loaded.scene);
}

/// Plays a scene by its script, but for buttons and axes that change in every tick.
/// @param keyframe_at  The tick after which the state goes into the log; 0: none.
inline Match played(const std::string& name, std::uint64_t ticks, std::uint64_t keyframe_at = 0) {
  Match match;
  match.scene = catalogue_scene(name);
  scenes::Simulation simulation = std::move(scenes::Simulation::create(match.scene).value());
  protocol::LogHeader header = protocol::log_header_of(match.scene);
  header.salt = 0x5a17;
  protocol::LogEncoder encoder(header, match.log);
  const auto mark = [&](std::uint64_t tick) {
    match.ends.push_back(match.log.size());
    match.ticks_until.push_back(static_cast<std::size_t>(tick));
  };
  mark(0);
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
    mark(tick);
    if (tick != keyframe_at) continue;
    protocol::Bytes state;
    simulation.encode(state);
    encoder.keyframe(record.digest, state, match.log);
    mark(tick);
  }
  encoder.footer({ticks, match.digests.back(), {}}, match.log);
  mark(ticks);
  match.checks = check_places(match.log);
  return match;
}

inline constexpr std::size_t kSceneDigestPlace = 24;  ///< Of a log's header: docs/protocol.md.
inline constexpr std::size_t kSaltPlace = 32;

/// Makes every check of a log fit again, as a writer who means harm would. Header, heads and chunks
/// are taken to lie where they lay in the original, all in one block.
/// @param checks  As in the Match.
inline void refit_checks(const std::vector<std::size_t>& checks, protocol::Bytes& log) {
  const std::span<const std::byte> bytes(log);
  std::uint32_t check = protocol::crc32c(bytes.first(checks[0] - 4));
  solver::store_little(check, log.data() + checks[0] - 4);
  const std::uint32_t salted =
      protocol::salted(solver::load_little<std::uint64_t>(log.data() + kSaltPlace));
  for (std::size_t i = 1; i < checks.size(); ++i) {
    const bool head = i == 1;
    if (head) solver::store_little(check, log.data() + checks[1] - 8);
    const auto body = bytes.subspan(checks[i - 1], checks[i] - checks[i - 1] - 4);
    check = head ? protocol::block_check(salted, body) : protocol::chunk_check(salted, check, body);
    solver::store_little(check, log.data() + checks[i] - 4);
  }
}

}  // namespace cycloid::hostile
