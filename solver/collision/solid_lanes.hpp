#pragma once

#include <cstddef>

#include "solver/collision/solid_kernels.hpp"
#include "solver/transpose.hpp"

namespace cycloid::solver {

/// The text of SolidKernels, for the files that compile it and no others. Every function is a
/// template on W, so that those compiled for one instruction set have names of their own.

/// The least in any lane. The sign of a zero may be that of any of those that are equal.
template <int W>
[[gnu::always_inline]] inline float least_of(const Lanes<W>& a) {
  static_assert(kLaneCount<W> % 4 == 0);
  Quad quads[kLaneCount<W> / 4];
  std::memcpy(quads, &a.raw, sizeof quads);
  Quad of_four = quads[0];
  for (int i = 1; i < kLaneCount<W> / 4; ++i) of_four = quads[i] < of_four ? quads[i] : of_four;
  float least = of_four[0];
  for (int i = 1; i < 4; ++i) least = of_four[i] < least ? of_four[i] : least;
  return least;
}

template <int W>
[[gnu::always_inline]] inline std::uint32_t first_of(std::uint32_t bits) {
  return static_cast<std::uint32_t>(__builtin_ctz(bits));
}

/// Records of which the last stands for those behind it.
template <int W, class Record>
[[gnu::always_inline]] inline void gather_from(const Record* records, std::uint32_t begin,
                                               std::uint32_t count, Lanes<W> (&columns)[4]) {
  LaneIndices<W> at;
  for (std::uint32_t lane = 0; lane < kLaneCount<W>; ++lane)
    at[lane] = begin + lane < count ? begin + lane : count - 1;
  gather_floats<W>(records, at, 0, columns);
}

template <int W>
std::uint32_t SolidKernels<W>::face_towards(const PolyhedronFace* faces, std::uint32_t count,
                                            const Vec<3>& point) {
  using L = Lanes<W>;
  static_assert(offsetof(PolyhedronFace, offset) == 3 * sizeof(float));
  static_assert(sizeof(PolyhedronFace) >= sizeof(Quad));
  // How far inside, so that the least is sought.
  L inside[in_whole_lanes(kHullFacesMax) / kLaneCount<W>];
  L nearest(3.4e38f);
  for (std::uint32_t i = 0; i < count; i += kLaneCount<W>) {
    L plane[4];
    gather_from<W>(faces, i, count, plane);
    const L outside =
        plane[0] * L(point.v[0]) + plane[1] * L(point.v[1]) + plane[2] * L(point.v[2]) - plane[3];
    inside[i / kLaneCount<W>] = -outside;
    nearest = min(nearest, -outside);
  }
  const L least(least_of<W>(nearest));
  for (std::uint32_t i = 0; i < count; i += kLaneCount<W>) {
    const std::uint32_t bits = bits_of<W>(inside[i / kLaneCount<W>] == least);
    if (bits != 0) return i + first_of<W>(bits);
  }
  return 0;  // Of what is no number.
}

template <int W>
float SolidKernels<W>::lowest_along(const PolyhedronVertex* corners, std::uint32_t count,
                                    const Vec<3>& direction) {
  using L = Lanes<W>;
  static_assert(sizeof(PolyhedronVertex) == sizeof(Quad));
  L lowest(0.0f);
  for (std::uint32_t i = 0; i < count; i += kLaneCount<W>) {
    L corner[4];
    gather_from<W>(corners, i, count, corner);
    lowest = min(lowest, corner[0] * L(direction.v[0]) + corner[1] * L(direction.v[1]) +
                             corner[2] * L(direction.v[2]));
  }
  return least_of<W>(lowest);
}

/// How far each corner is outside of each face, corner by corner. A template on W like all here.
template <int W>
struct FaceHeights {
  std::uint32_t stride;  ///< From a corner to the next.
  float of_corners[kHullVerticesMax * in_whole_lanes(kHullFacesMax)];
  float lowest[in_whole_lanes(kHullFacesMax)];  ///< By face.

  float at(std::uint32_t corner, std::uint32_t face) const {
    return of_corners[corner * stride + face];
  }
};

template <int W>
[[gnu::always_inline]] inline void find_heights(const WidePlanes& planes, const Vec<3>* corners,
                                                std::uint32_t count, FaceHeights<W>& heights) {
  using L = Lanes<W>;
  heights.stride = in_whole_lanes(planes.count);
  for (std::uint32_t face = 0; face < planes.count; face += kLaneCount<W>) {
    const L normal[3] = {L::load(planes.normals.part[0] + face),
                         L::load(planes.normals.part[1] + face),
                         L::load(planes.normals.part[2] + face)};
    const L offset = L::load(planes.offsets + face);
    L lowest(3.4e38f);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec<3>& at = corners[i];
      const L height =
          normal[0] * L(at.v[0]) + normal[1] * L(at.v[1]) + normal[2] * L(at.v[2]) - offset;
      height.store(heights.of_corners + i * heights.stride + face);
      lowest = min(lowest, height);
    }
    lowest.store(heights.lowest + face);
  }
}

/// The first face from this one on that a corner is farther outside of than `threshold`.
template <int W>
[[gnu::always_inline]] inline std::uint32_t first_outside(const FaceHeights<W>& heights,
                                                          std::uint32_t face, std::uint32_t faces,
                                                          std::uint32_t corner, float threshold) {
  using L = Lanes<W>;
  const float* row = heights.of_corners + corner * heights.stride;
  std::uint32_t begin = face & ~static_cast<std::uint32_t>(kLaneCount<W> - 1);
  std::uint32_t wanted = ~std::uint32_t{0} << (face - begin);
  for (; begin < faces; begin += kLaneCount<W>, wanted = ~std::uint32_t{0}) {
    const std::uint32_t bits = wanted & bits_of<W>(L::load(row + begin) > L(threshold));
    if (bits != 0) return begin + first_of<W>(bits);
  }
  return faces;
}

template <int W>
void SolidKernels<W>::best_face(const WidePlanes& planes, const Vec<3>* corners,
                                std::uint32_t count, const FaceTolerance& tolerance, float margin,
                                FaceAxis& best) {
  FaceHeights<W> heights;
  find_heights<W>(planes, corners, count, heights);
  float threshold = best.separation;
  std::uint32_t guess = 0;
  for (std::uint32_t face = first_outside<W>(heights, 0, planes.count, guess, threshold);
       face < planes.count;
       face = first_outside<W>(heights, face + 1, planes.count, guess, threshold)) {
    const float lowest = heights.lowest[face];
    if (!(lowest > threshold)) {
      for (guess = 0; heights.at(guess, face) > threshold;) ++guess;
      continue;
    }
    if (heights.at(guess, face) != lowest)
      for (guess = 0; heights.at(guess, face) != lowest;) ++guess;
    // The corner's own height, which is the same zero at every width.
    best.face = face;
    best.support = guess;
    best.separation = heights.at(guess, face);
    if (lowest > margin) return;
    threshold = tolerance.beyond(lowest);
  }
}

}  // namespace cycloid::solver
