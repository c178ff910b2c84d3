#include "solver/collision/solid.hpp"

namespace cycloid::solver {
Manifold<3> solid_against_rod(const Solid&, const Rod&, const Vec<3>&, float) {
  return {};
}
Manifold<3> rod_against_rod(const Rod&, const Rod&, const Vec<3>&, float) {
  return {};
}
Manifold<3> triangle_against_solid(const Solid&, const Solid&, const Vec<3>&, float) {
  return {};
}
Manifold<3> triangle_against_rod(const Solid&, const Rod&, const Vec<3>&, float) {
  return {};
}
}  // namespace cycloid::solver
