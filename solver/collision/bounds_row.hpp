#pragma once

#include <cstdint>

#include "solver/collision/bounds.hpp"

namespace cycloid::solver {

/// Sixteen boxes that are asked together which of them overlap another. An empty place overlaps
/// none that is finite.
template <int D>
struct alignas(64) BoundsRow {
  static constexpr int kBoxes = 16;

  float lower[D][kBoxes];
  float upper[D][kBoxes];

  static BoundsRow empty() {
    BoundsRow row;
    for (int place = 0; place < kBoxes; ++place) row.clear(place);
    return row;
  }
  void set(int place, const Bounds<D>& box) {
    for (int i = 0; i < D; ++i) {
      lower[i][place] = box.lower[i];
      upper[i][place] = box.upper[i];
    }
  }
  void clear(int place) {
    for (int i = 0; i < D; ++i) {
      lower[i][place] = 3.4e38f;
      upper[i][place] = -3.4e38f;
    }
  }

  /// What holds all of them. @pre one is there.
  Bounds<D> all() const {
    Bounds<D> box;
    for (int i = 0; i < D; ++i) {
      box.lower[i] = lower[i][0];
      box.upper[i] = upper[i][0];
      for (int place = 1; place < kBoxes; ++place) {
        box.lower[i] = min(box.lower[i], lower[i][place]);
        box.upper[i] = max(box.upper[i], upper[i][place]);
      }
    }
    return box;
  }
};

}  // namespace cycloid::solver
