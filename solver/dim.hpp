#pragma once

#include "solver/lanes.hpp"

namespace cycloid::solver {

/// D numbers of type T: a float, or a `Lanes<W>` in a wide kernel.
///
/// Plain arrays rather than Eigen vectors because the state must be trivially copyable (a save is
/// a memcpy), which Eigen 3.4's matrices are not, and because the same text has to run on lanes.
template <int D, class T = float>
struct Vec {
  T v[D];

  constexpr T& operator[](int i) { return v[i]; }
  constexpr const T& operator[](int i) const { return v[i]; }
  static constexpr Vec zero() {
    Vec r{};
    for (int i = 0; i < D; ++i) r.v[i] = T(0.0f);
    return r;
  }
  friend Vec operator+(Vec a, const Vec& b) {
    for (int i = 0; i < D; ++i) a.v[i] = a.v[i] + b.v[i];
    return a;
  }
  friend Vec operator-(Vec a, const Vec& b) {
    for (int i = 0; i < D; ++i) a.v[i] = a.v[i] - b.v[i];
    return a;
  }
  friend Vec operator-(Vec a) {
    for (int i = 0; i < D; ++i) a.v[i] = -a.v[i];
    return a;
  }
  friend Vec operator*(T s, Vec a) {
    for (int i = 0; i < D; ++i) a.v[i] = s * a.v[i];
    return a;
  }
  Vec& operator+=(const Vec& b) { return *this = *this + b; }
  Vec& operator-=(const Vec& b) { return *this = *this - b; }
  friend T dot(const Vec& a, const Vec& b) {
    T sum = a.v[0] * b.v[0];
    for (int i = 1; i < D; ++i) sum = sum + a.v[i] * b.v[i];
    return sum;
  }
};

/// All that differs between the plane and space; elsewhere 2 and 3 appear only in explicit
/// instantiations and in shapes that exist in one of them.
template <int D>
struct Dim {
  static_assert(D == 2 || D == 3);
  static constexpr int kSpin = D * (D - 1) / 2;          ///< Rotational freedoms: 1 or 3.
  static constexpr int kFreedoms = D + kSpin;            ///< Of a body: 3 or 6.
  static constexpr int kPinEqualities = D == 2 ? 2 : 5;  ///< Most of a pin: in space a hinge's.
  static constexpr int kTangents = D - 1;                ///< Friction directions per contact point.
  static constexpr int kRotation = D == 2 ? 2 : 4;       ///< (cos, sin) or quaternion (x, y, z, w).
  static constexpr int kManifoldPoints = D == 2 ? 2 : 4;
  static constexpr int kVertices = D == 2 ? 8 : 64;     ///< Most vertices of one convex shape.
  static constexpr int kMortonBits = D == 2 ? 16 : 10;  ///< Per axis; all axes fit 32 bits.
  static constexpr int kMotionFloats = D == 2 ? 8 : 16;
};

/// Angular velocity or torque: rad/s or N m.
template <int D, class T = float>
using Spin = Vec<Dim<D>::kSpin, T>;

/// Symmetric second moment of mass, row-major: kg m^2.
template <int D>
struct Inertia {
  float m[Dim<D>::kSpin * Dim<D>::kSpin];
};

/// A unit complex number (cos, sin), or a unit quaternion (x, y, z, w).
template <int D, class T = float>
using Rotation = Vec<Dim<D>::kRotation, T>;

template <class T>
T cross(const Vec<2, T>& a, const Vec<2, T>& b) {
  return a[0] * b[1] - a[1] * b[0];
}
template <class T>
[[gnu::always_inline]] inline Vec<3, T> cross(const Vec<3, T>& a, const Vec<3, T>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

/// w x r: velocity [m/s] of the point at r [m] from the centre of a body that spins at w.
template <class T>
Vec<2, T> spin_cross(const Vec<1, T>& w, const Vec<2, T>& r) {
  return {{-w[0] * r[1], w[0] * r[0]}};
}
template <class T>
Vec<3, T> spin_cross(const Vec<3, T>& w, const Vec<3, T>& r) {
  return cross(w, r);
}

/// r x f: moment of f at r, as a spin.
template <class T>
Vec<1, T> moment(const Vec<2, T>& r, const Vec<2, T>& f) {
  return {{cross(r, f)}};
}
template <class T>
Vec<3, T> moment(const Vec<3, T>& r, const Vec<3, T>& f) {
  return cross(r, f);
}

template <int D>
constexpr Rotation<D> identity_rotation() {
  Rotation<D> q = Rotation<D>::zero();
  q[D == 2 ? 0 : 3] = 1.0f;
  return q;
}

// Always inline: GCC makes calls of these where they are used most, which costs a fifth of a step
// of jointed bodies in space.
template <class T>
[[gnu::always_inline]] inline Vec<2, T> rotate(const Vec<2, T>& q, const Vec<2, T>& r) {
  return {{q[0] * r[0] - q[1] * r[1], q[1] * r[0] + q[0] * r[1]}};
}
template <class T>
[[gnu::always_inline]] inline Vec<2, T> rotate_back(const Vec<2, T>& q, const Vec<2, T>& r) {
  return {{q[0] * r[0] + q[1] * r[1], q[0] * r[1] - q[1] * r[0]}};
}
template <class T>
[[gnu::always_inline]] inline Vec<3, T> rotate(const Vec<4, T>& q, const Vec<3, T>& r) {
  const Vec<3, T> u = {{q[0], q[1], q[2]}};
  const Vec<3, T> t = T(2.0f) * cross(u, r);
  return r + q[3] * t + cross(u, t);
}
template <class T>
[[gnu::always_inline]] inline Vec<3, T> rotate_back(const Vec<4, T>& q, const Vec<3, T>& r) {
  return rotate(Vec<4, T>{{-q[0], -q[1], -q[2], q[3]}}, r);
}

/// Where a rotation takes the unit vectors: the columns of its matrix.
template <class T>
void rotated_axes(const Vec<2, T>& q, Vec<2, T> (&axes)[2]) {
  axes[0] = {{q[0], q[1]}};
  axes[1] = {{-q[1], q[0]}};
}
template <class T>
void rotated_axes(const Vec<4, T>& q, Vec<3, T> (&axes)[3]) {
  const T one = T(1.0f);
  const T two = T(2.0f);
  axes[0] = {{one - two * (q[1] * q[1] + q[2] * q[2]), two * (q[0] * q[1] + q[3] * q[2]),
              two * (q[0] * q[2] - q[3] * q[1])}};
  axes[1] = {{two * (q[0] * q[1] - q[3] * q[2]), one - two * (q[0] * q[0] + q[2] * q[2]),
              two * (q[1] * q[2] + q[3] * q[0])}};
  axes[2] = {{two * (q[0] * q[2] + q[3] * q[1]), two * (q[1] * q[2] - q[3] * q[0]),
              one - two * (q[0] * q[0] + q[1] * q[1])}};
}

/// The rotation `a` after the rotation `b`.
template <class T>
[[gnu::always_inline]] inline Vec<2, T> compose(const Vec<2, T>& a, const Vec<2, T>& b) {
  return {{a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]}};
}
template <class T>
[[gnu::always_inline]] inline Vec<4, T> compose(const Vec<4, T>& a, const Vec<4, T>& b) {
  return {{a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
           a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
           a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
           a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]}};
}

template <class T>
[[gnu::always_inline]] inline Vec<2, T> conjugate(const Vec<2, T>& q) {
  return {{q[0], -q[1]}};
}
template <class T>
[[gnu::always_inline]] inline Vec<4, T> conjugate(const Vec<4, T>& q) {
  return {{-q[0], -q[1], -q[2], q[3]}};
}

/// dq of a small turn [rad] in the world frame.
template <class T>
Vec<2, T> turn_derivative(const Vec<1, T>& turn, const Vec<2, T>& q) {
  return {{-turn[0] * q[1], turn[0] * q[0]}};
}
template <class T>
Vec<4, T> turn_derivative(const Vec<3, T>& turn, const Vec<4, T>& q) {
  const T half = T(0.5f);
  return compose(Vec<4, T>{{half * turn[0], half * turn[1], half * turn[2], T(0.0f)}}, q);
}

template <int N, class T>
T length(const Vec<N, T>& a) {
  return sqrt(dot(a, a));
}

/// `a` at unit length, or `fallback` where `a` has no direction.
template <int N>
Vec<N> normalized_or(const Vec<N>& a, const Vec<N>& fallback) {
  const float l = length(a);
  return l > 1e-12f ? (1.0f / l) * a : fallback;
}

/// I w in the frame of I.
template <int D>
Spin<D> operator*(const Inertia<D>& inertia, const Spin<D>& w) {
  constexpr int kSpin = Dim<D>::kSpin;
  Spin<D> r = Spin<D>::zero();
  for (int i = 0; i < kSpin; ++i)
    for (int j = 0; j < kSpin; ++j) r[i] = r[i] + inertia.m[i * kSpin + j] * w[j];
  return r;
}

/// R I R^T: a body-frame inertia in the world frame. In the plane a rotation changes nothing.
inline Inertia<2> world_inertia(const Inertia<2>& local, const Rotation<2>&) {
  return local;
}
inline Inertia<3> world_inertia(const Inertia<3>& local, const Rotation<3>& q) {
  Inertia<3> world;
  for (int column = 0; column < 3; ++column) {
    Vec<3> axis = Vec<3>::zero();
    axis[column] = 1.0f;
    const Vec<3> turned = rotate(q, local * rotate_back(q, axis));
    for (int row = 0; row < 3; ++row) world.m[row * 3 + column] = turned[row];
  }
  return world;
}

/// Unit directions that complete `normal` to a basis: the friction directions of a contact.
template <class T>
void tangents(const Vec<2, T>& normal, Vec<2, T> (&out)[1]) {
  out[0] = {{normal[1], -normal[0]}};
}
/// Source: Duff et al., "Building an Orthonormal Basis, Revisited" (JCGT 2017), with the sign as a
/// select, so that -0 and +0 give the same basis.
template <class T>
void tangents(const Vec<3, T>& n, Vec<3, T> (&out)[2]) {
  const T sign = select(n[2] < T(0.0f), T(-1.0f), T(1.0f));
  const T a = T(-1.0f) / (sign + n[2]);
  const T b = n[0] * n[1] * a;
  out[0] = {{T(1.0f) + sign * n[0] * n[0] * a, sign * b, -sign * n[0]}};
  out[1] = {{b, sign + n[1] * n[1] * a, -n[1]}};
}

}  // namespace cycloid::solver
