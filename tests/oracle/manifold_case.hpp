#pragma once

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "solver/collision/collide.hpp"
#include "tests/oracle/manifold_checks.hpp"

namespace cycloid::oracle {

/// A pair, its manifold, and what has been found wrong with it.
struct Case {
  const Pair& pair;
  PlacedPair bodies;
  Truth truth;
  solver::Manifold<3> manifold;
  const Tolerance& allowed;
  double tolerance;
  std::vector<Complaint> complaints;

  template <class... Numbers>
  void complain(const char* what, const Numbers&... numbers) {
    std::ostringstream out;
    out.precision(9);
    ((out << numbers << " "), ...);
    complaints.push_back({what, out.str()});
  }
  double least() const {
    double least = INFINITY;
    for (std::uint32_t i = 0; i < manifold.point_count; ++i)
      least = std::min(least, static_cast<double>(manifold.points[i].separation));
    return least;
  }
};

/// The other order of the shapes gives the same depth and separations.
void check_swapped(Case& c, const solver::Polyhedra& polyhedra);

/// 1024 m away, positions that are exact there too give the same bits; others the same depth.
void check_moved(Case& c, const solver::Polyhedra& polyhedra);

}  // namespace cycloid::oracle
