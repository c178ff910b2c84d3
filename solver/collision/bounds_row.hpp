#pragma once

#include <cstdint>

#include "solver/collision/bounds.hpp"
#include "solver/lanes.hpp"

namespace cycloid::solver {

/// Four boxes that are asked at once which of them overlap another. An empty place overlaps none
/// that is finite.
template <int D>
struct BoundsRow {
  Lanes<4> lower[D];
  Lanes<4> upper[D];

  static BoundsRow empty() {
    BoundsRow row;
    for (int lane = 0; lane < 4; ++lane) row.clear(lane);
    return row;
  }
  void set(int lane, const Bounds<D>& box) {
    for (int i = 0; i < D; ++i) {
      lower[i].raw[lane] = box.lower[i];
      upper[i].raw[lane] = box.upper[i];
    }
  }
  void clear(int lane) {
    for (int i = 0; i < D; ++i) {
      lower[i].raw[lane] = 3.4e38f;
      upper[i].raw[lane] = -3.4e38f;
    }
  }

  /// What holds all of them. @pre one is there.
  Bounds<D> all() const {
    Bounds<D> box;
    for (int i = 0; i < D; ++i) {
      const auto& low = lower[i].raw;
      const auto& high = upper[i].raw;
      box.lower[i] = min(min(low[0], low[1]), min(low[2], low[3]));
      box.upper[i] = max(max(high[0], high[1]), max(high[2], high[3]));
    }
    return box;
  }

  /// Bit i tells of the box in place i.
  [[gnu::always_inline]] std::uint32_t overlapping(const Bounds<D>& box) const {
    typename Lanes<4>::Mask apart{};
    for (int i = 0; i < D; ++i)
      apart = apart | (lower[i] > Lanes<4>(box.upper[i])) | (Lanes<4>(box.lower[i]) > upper[i]);
    return bits_of<4>(~apart);
  }
};

}  // namespace cycloid::solver
