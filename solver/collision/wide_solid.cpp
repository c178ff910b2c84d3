#include "solver/collision/wide_solid.hpp"

namespace cycloid::solver {

WidePlanes::WidePlanes(const Solid& solid) : count(solid.face_count) {
  for (std::uint32_t face = 0; face < count; ++face) {
    normals.set(face, solid.normals[face]);
    offsets[face] = solid.offset(face);
  }
  for (std::uint32_t i = count; i < in_whole_lanes(count); ++i) {
    normals.set(i, Vec<3>::zero());
    offsets[i] = 3.0e38f;
  }
}

}  // namespace cycloid::solver
