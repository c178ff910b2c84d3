#pragma once

namespace cycloid::solver {

/// A = L D L^T of a small symmetric matrix: L unit lower triangular, D stored inverted.
///
/// The inverse of a pivot is 0 where the row and its diagonal are empty, so that a solve leaves
/// that unknown at 0 instead of dividing by zero.
template <int N>
struct SmallFactor {
  float lower[N][N];  ///< Strictly below the diagonal; the rest is unused.
  float inverse_pivot[N];
};

/// Factors the leading `size` rows of the symmetric `matrix` without reordering; only its lower
/// triangle is read. A pivot below `floor[i]` (a bound the caller knows, >= 0) is raised to it,
/// which adds to the diagonal what rounding or redundancy took away. Always succeeds: the result
/// is finite for finite input whose floors and pivots are 0 or normal numbers.
template <int N>
void factor_small(const float (&matrix)[N][N], const float (&floor)[N], int size,
                  SmallFactor<N>& factor) {
  float pivot[N];
  for (int i = 0; i < size; ++i) {
    // Row i of L D, before its division by the pivots.
    float row[N];
    float diagonal = matrix[i][i];
    for (int j = 0; j < i; ++j) {
      float sum = matrix[i][j];
      for (int k = 0; k < j; ++k) sum = sum - row[k] * factor.lower[j][k];
      row[j] = sum;
      factor.lower[i][j] = sum * factor.inverse_pivot[j];
      diagonal = diagonal - sum * factor.lower[i][j];
    }
    pivot[i] = diagonal > floor[i] ? diagonal : floor[i];
    factor.inverse_pivot[i] = pivot[i] > 0.0f ? 1.0f / pivot[i] : 0.0f;
  }
}

/// Replaces x by L^-1 x.
template <int N>
void solve_lower(const SmallFactor<N>& factor, int size, float (&x)[N]) {
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < i; ++j) x[i] = x[i] - factor.lower[i][j] * x[j];
}

/// Replaces x by A^-1 x.
template <int N>
void solve_small(const SmallFactor<N>& factor, int size, float (&x)[N]) {
  solve_lower(factor, size, x);
  for (int i = 0; i < size; ++i) x[i] = x[i] * factor.inverse_pivot[i];
  for (int i = size - 1; i >= 0; --i)
    for (int j = i + 1; j < size; ++j) x[i] = x[i] - factor.lower[j][i] * x[j];
}

/// Adds B^T A^-1 B to the leading `columns` x `columns` of `sum`, where B is the `size` x `columns`
/// matrix given by its columns: `b[column][row]`. A sum of squares, so it cannot lose its sign.
template <int N>
void add_gram(const SmallFactor<N>& factor, int size, const float (&b)[N][N], int columns,
              float (&sum)[N][N]) {
  float reduced[N][N];
  for (int c = 0; c < columns; ++c) {
    for (int i = 0; i < size; ++i) reduced[c][i] = b[c][i];
    solve_lower(factor, size, reduced[c]);
  }
  for (int c = 0; c < columns; ++c)
    for (int d = 0; d <= c; ++d) {
      float term = 0.0f;
      for (int i = 0; i < size; ++i)
        term = term + reduced[c][i] * factor.inverse_pivot[i] * reduced[d][i];
      sum[c][d] = sum[c][d] + term;
      if (d != c) sum[d][c] = sum[c][d];
    }
}

/// Subtracts B x from y, where B is the leading `rows` rows of a matrix.
template <int N>
void subtract_product(const float (&b)[N][N], int rows, const float (&x)[N], float (&y)[N]) {
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < N; ++j) y[i] = y[i] - b[i][j] * x[j];
}

/// Adds B^T x to y, where B is the leading `rows` rows of a matrix.
template <int N>
void add_transposed_product(const float (&b)[N][N], int rows, const float (&x)[N], float (&y)[N]) {
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < N; ++j) y[j] = y[j] + b[i][j] * x[i];
}

}  // namespace cycloid::solver
