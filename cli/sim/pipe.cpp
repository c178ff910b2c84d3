#include "cli/sim/pipe.hpp"

#include <algorithm>

namespace cycloid::sim {

std::size_t Pipe::write(std::span<const std::byte> bytes) {
  if (finished_ || reset_) return bytes.size();  // As the kernel does with what nobody will read.
  const std::size_t held = held_bytes();
  const std::size_t taken = std::min(bytes.size(), faults_.capacity_bytes - held);
  if (taken == 0) return 0;
  if (begin_ != 0) {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
  }
  if (random_.chance(faults_.stall_per_million) && last_ns_ != kNever) {
    last_ns_ = std::max(last_ns_, chronicle_->now_ns) + faults_.stall_ns;
    chronicle_->count(Event::kStall);
  }
  for (std::size_t done = 0; done < taken;) {
    std::size_t size = faults_.segment_bytes_max;
    if (!faults_.whole_segments) size = 1 + random_.below(faults_.segment_bytes_max);
    size = std::min(size, taken - done);
    const auto cut = bytes.subspan(done, size);
    buffer_.insert(buffer_.end(), cut.begin(), cut.end());
    if (random_.chance(faults_.flip_per_million)) {
      const std::size_t byte = buffer_.size() - size + random_.below(size);
      buffer_[byte] ^= static_cast<std::byte>(1u << random_.below(8));
      ++flips_;
      chronicle_->count(Event::kBitFlip);
    }
    if (size == 1) chronicle_->count(Event::kOneByteSegment);
    segments_.push_back({arrival_ns(size), size});
    done += size;
  }
  return taken;
}

std::int64_t Pipe::arrival_ns(std::size_t bytes) {
  const std::int64_t now = chronicle_->now_ns;
  free_ns_ = std::max(free_ns_, now);
  if (faults_.bytes_per_s != 0) {
    free_ns_ += static_cast<std::int64_t>(bytes * static_cast<std::uint64_t>(kSecond) /
                                          faults_.bytes_per_s);
  }
  std::int64_t at = free_ns_ + faults_.latency_ns;
  if (faults_.jitter_ns > 0) at += random_.between(0, faults_.jitter_ns);
  if (now >= faults_.blackhole_from_ns && now < faults_.blackhole_until_ns) {
    at = std::max(at, faults_.blackhole_until_ns);
    if (!swallowed_) chronicle_->count(Event::kBlackhole);
    swallowed_ = true;
  }
  last_ns_ = std::max(last_ns_, at);
  return last_ns_;
}

void Pipe::finish() {
  if (finished_ || reset_) return;
  finished_ = true;
  end_ns_ = arrival_ns(1);
}

void Pipe::reset() {
  reset_ = true;
  buffer_.clear();
  begin_ = 0;
  segments_.clear();
}

std::span<const std::byte> Pipe::read(std::size_t bytes_max) {
  std::size_t bytes = 0;
  std::size_t segments = 0;
  while (!segments_.empty() && segments_.front().at_ns <= chronicle_->now_ns && bytes < bytes_max &&
         (segments == 0 || faults_.coalesces)) {
    const std::size_t part = std::min(segments_.front().bytes, bytes_max - bytes);
    bytes += part;
    ++segments;
    segments_.front().bytes -= part;
    if (segments_.front().bytes == 0) segments_.pop_front();
  }
  if (segments > 1) chronicle_->count(Event::kCoalesced);
  const auto came = std::span<const std::byte>(buffer_).subspan(begin_, bytes);
  begin_ += bytes;
  return came;
}

void Pipe::calm() {
  const std::int64_t now = chronicle_->now_ns;
  PipeFaults none;
  none.capacity_bytes = std::max(none.capacity_bytes, faults_.capacity_bytes);
  if (is_lost()) none.blackhole_from_ns = faults_.blackhole_from_ns;
  const auto soon = [&](std::int64_t& at_ns) {
    if (at_ns != kNever) at_ns = std::min(at_ns, now + none.latency_ns);
  };
  for (Segment& segment : segments_) soon(segment.at_ns);
  soon(last_ns_);
  soon(free_ns_);
  soon(end_ns_);
  faults_ = none;
}

}  // namespace cycloid::sim
