#include <algorithm>

#include "protocol/codec.hpp"
#include "protocol/little_endian.hpp"

namespace cycloid::protocol {

// The limit is checked when a message comes first in line, not when its bytes come in: so the
// answer does not depend on how the stream was cut, and the limit may rise between two messages.

bool Framer::feed(std::span<const std::byte> bytes) {
  if (broken_) return false;
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_ + taken_));
  begin_ = taken_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  check_first();
  return !broken_;
}

std::optional<std::span<const std::byte>> Framer::next() {
  begin_ += taken_;
  taken_ = 0;
  check_first();
  const std::size_t held = buffer_.size() - begin_;
  if (broken_ || held < kPrefixBytes || held - kPrefixBytes < announced_bytes()) return {};
  const std::size_t payload_bytes = announced_bytes();
  taken_ = kPrefixBytes + payload_bytes;
  return std::span<const std::byte>(buffer_).subspan(begin_ + kPrefixBytes, payload_bytes);
}

std::uint32_t Framer::announced_bytes() const {
  if (buffer_.size() - begin_ < kPrefixBytes) return 0;
  return solver::load_little<std::uint32_t>(buffer_.data() + begin_);
}

void Framer::check_first() {
  if (buffer_.size() - begin_ < kPrefixBytes) return;
  const std::uint32_t announced = announced_bytes();
  if (announced == 0 || announced > payload_bytes_max_) broken_ = true;
}

}  // namespace cycloid::protocol
