#pragma once

#include "solver/collision/wide_solid.hpp"

namespace cycloid::solver {

/// A face of one solid as an axis.
struct FaceAxis {
  std::uint32_t face;
  std::uint32_t support;  ///< The other's vertex that is deepest below the face.
  float separation;
};

/// What a face has to beat: the best one before it by `least`, and a part of its depth.
struct FaceTolerance {
  float least;  ///< m
  float of_depth;

  /// The separation that a face has to exceed after the best one, m.
  [[gnu::always_inline]] float beyond(float best) const {
    return best + least + of_depth * select(-best > 0.0f, -best, 0.0f);
  }
};

/// Searches of the faces and corners of solids, compiled for each instruction set:
/// solid_kernels.cpp, solid_kernels_avx2.cpp and solid_kernels_avx512.cpp. What they find does not
/// depend on W.
template <int W>
struct SolidKernels {
  /// The face of a hull that a point of its own frame is farthest outside of: of equals the first.
  static std::uint32_t face_towards(const PolyhedronFace* faces, std::uint32_t count,
                                    const Vec<3>& point);
  /// The least dot(corner, direction) over the corners of a hull in its own frame, and 0.
  static float lowest_along(const PolyhedronVertex* corners, std::uint32_t count,
                            const Vec<3>& direction);
  /// The face that the corners, one at least, are farthest outside of, in the order of the faces: a
  /// later one has to beat the best by the tolerance. Ends at a face that separates by more than
  /// `margin`. Of equally deep corners the support is the one that was deepest last, or showed last
  /// that a face does not win; else the first. `best` stays where no face exceeds its separation.
  static void best_face(const WidePlanes& planes, const Vec<3>* corners, std::uint32_t count,
                        const FaceTolerance& tolerance, float margin, FaceAxis& best);
};

}  // namespace cycloid::solver
