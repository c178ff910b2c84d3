#pragma once

#include <Eigen/Dense>

namespace cycloid::reference {

/// What Lemke's method came to.
struct LemkeResult {
  Eigen::VectorXd z;  ///< z >= 0 of the last basis.
  int pivots = 0;
};

/// Finds z >= 0 with w = M z + q >= 0 and z w = 0 per row, by complementary pivoting.
/// `covering` > 0 is the direction in which the artificial variable relaxes all rows; another one
/// may find another solution. Ties are broken lexicographically, so that the method ends in exact
/// arithmetic; in floating point it ends after pivots_max. For copositive M (contacts with friction
/// in the form of Stewart and Trinkle 1996) it finds a solution wherever b is a velocity of bodies.
/// Whether z is a solution is for the caller to measure: it is none where the method ended in a ray
/// or after pivots_max.
/// Preconditions: M is square, and q and covering have its size; entries are of order 1.
/// Source: Cottle, Pang, Stone 1992, "The Linear Complementarity Problem", 4.4 and 4.9.
LemkeResult solve_lemke(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& q,
                        const Eigen::VectorXd& covering, int pivots_max);

}  // namespace cycloid::reference
