#include "protocol/log_format.hpp"
#include "scenes/catalogue.hpp"
#include "server/desync/report_sink.hpp"

namespace cycloid::server {

/// The seats of the frame that made the state, or nobody's where that frame is not kept: only where
/// the inputs of the next ticks are told as differences from.
static std::vector<protocol::SeatFrame> seats_before(const Finding& finding) {
  for (const protocol::LogTick& tick : finding.ticks)
    if (tick.frame.tick == finding.start->tick) return tick.frame.seats;
  return std::vector<protocol::SeatFrame>(finding.room->scene->seats.size());
}

protocol::Bytes cut_log(const Finding& finding, const std::optional<KeptState>& before,
                        std::string& error) {
  protocol::Bytes bytes;
  const bool reaches = !finding.ticks.empty() && finding.ticks.back().frame.tick >= finding.tick;
  if (!finding.start || !reaches) {
    error = "the server no longer has the state and the frames before the tick";
    return bytes;
  }
  protocol::LogHeader header;
  header.scene_digest = finding.room->scene_digest;
  header.salt = finding.server_digest;  // The same finding writes the same bytes.
  header.tick_rate_millihertz = finding.room->tick_rate_millihertz;
  header.branch_tick = finding.start->tick;
  header.build = finding.room->build;
  header.room = finding.room->room;
  header.scene_name = finding.room->scene->name;
  header.scene = scenes::to_binary(*finding.room->scene);
  protocol::LogEncoder encoder(header, bytes);
  if (finding.start->tick > 0) {
    encoder.first_keyframe(
        {finding.start->tick, finding.start->digest, seats_before(finding), *finding.start->state},
        bytes);
  }
  std::uint64_t digest = finding.start->digest;
  for (const protocol::LogTick& tick : finding.ticks) {
    if (tick.frame.tick != encoder.next_tick()) continue;
    encoder.tick(tick, bytes);
    digest = tick.digest;
    if (before && before->tick == tick.frame.tick)
      encoder.keyframe(before->digest, *before->state, bytes);
  }
  encoder.footer({encoder.next_tick() - 1, digest, {}}, bytes);
  return bytes;
}

}  // namespace cycloid::server
