#include "protocol/log/encoder.hpp"

#include "protocol/log/records.hpp"

namespace cycloid::protocol {

static ChunkWriter chunks_behind_header(const LogHeader& header, Bytes& into) {
  const std::size_t begin = into.size();
  const std::uint32_t check = append_log_header(header, into);
  return {header.salt, check, into.size() - begin};
}

LogEncoder::LogEncoder(const LogHeader& header, Bytes& into)
    : next_tick_(header.branch_tick + 1), chunks_(chunks_behind_header(header, into)) {}

void LogEncoder::tick(const LogTick& tick, Bytes& into) {
  payload_.clear();
  append_tick(tick, seats_, payload_);
  chunks_.record(RecordKind::kTick, payload_, next_tick_, into);
  ++next_tick_;
}

void LogEncoder::keyframe(std::uint64_t digest, std::span<const std::byte> state, Bytes& into) {
  first_keyframe({next_tick_ - 1, digest, seats_, {state.begin(), state.end()}}, into);
}

void LogEncoder::first_keyframe(const LogKeyframe& keyframe, Bytes& into) {
  payload_.clear();
  append_keyframe(keyframe, payload_);
  seats_ = keyframe.seats;
  const ChunkWriter::Place place = chunks_.next_place(next_tick_, into);
  keyframes_.push_back({keyframe.tick, place.at, place.before});
  chunks_.record(RecordKind::kKeyframe, payload_, next_tick_, into);
}

void LogEncoder::footer(const LogFooter& footer, Bytes& into) {
  payload_.clear();
  append_footer({footer.ticks, footer.digest, keyframes_}, payload_);
  chunks_.record(RecordKind::kFooter, payload_, next_tick_, into);
}

}  // namespace cycloid::protocol
