#include "bench/reference/lemke.hpp"

#include <cmath>
#include <vector>

namespace cycloid::reference {

using Eigen::MatrixXd;
using Eigen::VectorXd;

static constexpr double kPivotMin = 1e-9;       ///< Smaller entries, of order 1, are rounding.
static constexpr double kTie = 1e-11;           ///< Ratios this close are the same.
static constexpr double kZero = 1e-13;          ///< Values up to this, of order 1, are 0.
static constexpr int kPivotsPerFactoring = 24;  ///< Before the inverse is computed afresh.

/// The equations I w - M z - covering z0 = q and the basis, which names one variable per row:
/// 0..m-1 are w, m..2m-1 are z, 2m is z0. The complement of w_i is z_i.
struct Tableau {
  const MatrixXd& matrix;
  const VectorXd& q;
  const VectorXd& covering;
  std::vector<int> basis;
  MatrixXd inverse;  ///< Of the columns of the basis: the tableau's columns of w.
  VectorXd values;   ///< Of the basic variables.
  int size() const { return static_cast<int>(q.size()); }
};

static VectorXd column_of(const Tableau& tableau, int variable) {
  const int m = tableau.size();
  if (variable < m) return VectorXd::Unit(m, variable);
  if (variable < 2 * m) return -tableau.matrix.col(variable - m);
  return -tableau.covering;
}

/// Computes the inverse from the basis alone, so that rounding does not build up. Where the basis
/// is singular to working precision, the inverse stays as it is.
static void refactor(Tableau& tableau) {
  const int m = tableau.size();
  MatrixXd columns(m, m);
  for (int i = 0; i < m; ++i) columns.col(i) = column_of(tableau, tableau.basis[i]);
  const Eigen::PartialPivLU<MatrixXd> factors(columns);
  const MatrixXd inverse = factors.inverse();
  const VectorXd values = factors.solve(tableau.q);
  if (!inverse.allFinite() || !values.allFinite()) return;
  tableau.inverse = inverse;
  tableau.values = values;
}

/// True where row i reaches 0 before row k when the variable enters: compares (values, inverse)
/// over the entering column, entry after entry, until they differ.
static bool leaves_before(const Tableau& tableau, const VectorXd& entering, int i, int k) {
  const double first = tableau.values[i] / entering[i];
  const double second = tableau.values[k] / entering[k];
  if (std::abs(first - second) > kTie) return first < second;
  for (int j = 0; j < tableau.size(); ++j) {
    const double a = tableau.inverse(i, j) / entering[i];
    const double b = tableau.inverse(k, j) / entering[k];
    if (std::abs(a - b) > kTie) return a < b;
  }
  return i < k;
}

/// The row whose variable leaves, or -1 where none does (a ray). z0 leaves as soon as it can,
/// because then the problem is solved.
static int leaving_row(const Tableau& tableau, const VectorXd& entering) {
  int best = -1;
  for (int i = 0; i < tableau.size(); ++i)
    if (entering[i] > kPivotMin && (best < 0 || leaves_before(tableau, entering, i, best)))
      best = i;
  if (best < 0) return -1;
  const double ratio = tableau.values[best] / entering[best];
  for (int i = 0; i < tableau.size(); ++i)
    if (tableau.basis[i] == 2 * tableau.size() && entering[i] > kPivotMin &&
        tableau.values[i] / entering[i] <= ratio + kTie)
      return i;
  return best;
}

/// Puts the variable into the basis at the row.
static void pivot(Tableau& tableau, int row, int variable, const VectorXd& entering) {
  tableau.basis[row] = variable;
  const Eigen::RowVectorXd scaled = tableau.inverse.row(row) / entering[row];
  const double value = tableau.values[row] / entering[row];
  for (int i = 0; i < tableau.size(); ++i) {
    if (i == row || entering[i] == 0.0) continue;
    tableau.inverse.row(i) -= entering[i] * scaled;
    tableau.values[i] -= entering[i] * value;
  }
  tableau.inverse.row(row) = scaled;
  tableau.values[row] = value;
}

/// The row that makes all others nonnegative when z0 enters there: the most negative in the
/// direction of the covering vector, the last of equals, which keeps the rows lexicographically
/// positive.
static int first_row(const VectorXd& q, const VectorXd& covering) {
  int best = 0;
  for (int i = 1; i < q.size(); ++i)
    if (q[i] / covering[i] <= q[best] / covering[best]) best = i;
  return best;
}

/// The value of z0, 0 where it is not basic; the problem is solved where it is 0.
static double relaxation_of(const Tableau& tableau) {
  for (int i = 0; i < tableau.size(); ++i)
    if (tableau.basis[i] == 2 * tableau.size()) return tableau.values[i];
  return 0.0;
}

static VectorXd solution_of(const Tableau& tableau) {
  const int m = tableau.size();
  VectorXd z = VectorXd::Zero(m);
  for (int i = 0; i < m; ++i)
    if (tableau.basis[i] >= m && tableau.basis[i] < 2 * m)
      z[tableau.basis[i] - m] = std::max(tableau.values[i], 0.0);
  return z;
}

LemkeResult solve_lemke(const MatrixXd& matrix, const VectorXd& q, const VectorXd& covering,
                        int pivots_max) {
  const int m = static_cast<int>(q.size());
  LemkeResult result{VectorXd::Zero(m), 0};
  if (m == 0 || q.minCoeff() >= -kZero) return result;
  Tableau tableau{matrix, q, covering, std::vector<int>(m), MatrixXd::Identity(m, m), q};
  for (int i = 0; i < m; ++i) tableau.basis[i] = i;

  int entering = 2 * m;
  int row = first_row(q, covering);
  VectorXd column = column_of(tableau, entering);
  while (row >= 0 && result.pivots < pivots_max) {
    const int left = tableau.basis[row];
    pivot(tableau, row, entering, column);
    ++result.pivots;
    const bool done = relaxation_of(tableau) <= kZero;
    if (done || result.pivots % kPivotsPerFactoring == 0) refactor(tableau);
    if (done) break;
    entering = left < m ? left + m : left - m;
    column = tableau.inverse * column_of(tableau, entering);
    row = leaving_row(tableau, column);
  }
  result.z = solution_of(tableau);
  return result;
}

}  // namespace cycloid::reference
