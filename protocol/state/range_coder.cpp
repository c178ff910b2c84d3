#include "protocol/state/range_coder.hpp"

namespace cycloid::protocol {

void RangeEncoder::finish() {
  // Every value of [low, low + range) says the same decisions: the one with most zero bits behind.
  for (unsigned bits = 32; bits-- > 0;) {
    const std::uint64_t step = std::uint64_t{1} << bits;
    const std::uint64_t rounded = (low_ + step - 1) / step * step;
    if (rounded < low_ + range_) {
      low_ = rounded;
      break;
    }
  }
  for (int i = 0; i < 5; ++i) shift_low();
  // The decoder reads zeros behind the end.
  while (into_.size() > begin_ && into_.back() == std::byte{0}) into_.pop_back();
}

}  // namespace cycloid::protocol
