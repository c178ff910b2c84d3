#pragma once

#include "solver/lanes.hpp"

namespace cycloid::solver {

/// K = L D L^T of a symmetric positive semi-definite K of at most N rows, T a float or lanes.
///
/// A pivot below 1e-6 of its diagonal belongs to a row that the rows before it already decide
/// (two hinges on one axle, a body that cannot turn): such a row gets no impulse.
template <int N, class T = float>
struct BlockFactor {
  T lower[N][N];
  T inverse_pivot[N];

  /// @param k  shape [count, count]; the lower triangle is read.
  void factor(const T (&k)[N][N], int count) {
    T pivot[N];
    const int rows = count < N ? count : N;  // So that a compiler sees the bound too.
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < i; ++j) {
        T sum = k[i][j];
        for (int m = 0; m < j; ++m) sum = sum - lower[i][m] * lower[j][m] * pivot[m];
        lower[i][j] = sum * inverse_pivot[j];
      }
      pivot[i] = k[i][i];
      for (int m = 0; m < i; ++m) pivot[i] = pivot[i] - lower[i][m] * lower[i][m] * pivot[m];
      const T least = T(1.0e-6f) * k[i][i];
      const auto decides = pivot[i] > least;
      pivot[i] = select(decides, pivot[i], T(0.0f));
      inverse_pivot[i] = select(decides, T(1.0f) / select(decides, pivot[i], T(1.0f)), T(0.0f));
    }
  }

  /// x = K^-1 x, in place.
  void solve(T (&x)[N], int count) const {
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < i; ++j) x[i] = x[i] - lower[i][j] * x[j];
    for (int i = 0; i < count; ++i) x[i] = inverse_pivot[i] * x[i];
    for (int i = count - 1; i >= 0; --i)
      for (int j = i + 1; j < count; ++j) x[i] = x[i] - lower[j][i] * x[j];
  }
};

}  // namespace cycloid::solver
