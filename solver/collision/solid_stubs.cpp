#include "solver/collision/solid.hpp"

namespace cycloid::solver {
Manifold<3> solid_against_solid(const Solid&, const Solid&, const Vec<3>&, float) {
  return {};
}
Manifold<3> box_against_box(const Solid&, const Solid&, const Vec<3>&, float) {
  return {};
}
void reduce(std::span<const Candidate> c, const Vec<3>& a_to_b, Manifold<3>& m) {
  for (std::size_t i = 0; i < c.size() && i < 4; ++i)
    add_point(c[i].at, c[i].separation, c[i].feature, a_to_b, m);
}
}  // namespace cycloid::solver
