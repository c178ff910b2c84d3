#pragma once

#include <cmath>

namespace cycloid::oracle {

/// Three doubles: a point or a direction. Nothing of the solver's arithmetic is used here, so that
/// an error in it cannot hide.
struct Vector {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  friend Vector operator+(const Vector& a, const Vector& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend Vector operator-(const Vector& a, const Vector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend Vector operator-(const Vector& a) { return {-a.x, -a.y, -a.z}; }
  friend Vector operator*(double s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
};

inline double dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vector& a) {
  return std::sqrt(dot(a, a));
}
/// @pre `a` is not zero.
inline Vector normalized(const Vector& a) {
  return (1.0 / length(a)) * a;
}

/// A direction at a right angle to `a`. @pre `a` is not zero.
inline Vector perpendicular(const Vector& a) {
  const Vector axis = std::abs(a.x) < 0.6 * length(a) ? Vector{1, 0, 0} : Vector{0, 1, 0};
  return normalized(cross(a, axis));
}

/// x -> rotation x + position, the rotation a unit quaternion (x, y, z, w).
struct Placement {
  Vector position;
  Vector imaginary;
  double real = 1.0;

  Vector turn(const Vector& v) const {
    const Vector t = 2.0 * cross(imaginary, v);
    return v + real * t + cross(imaginary, t);
  }
  Vector place(const Vector& v) const { return position + turn(v); }
};

/// A turn by `angle` [rad] about `axis`, which need not be of unit length, then a shift.
inline Placement turned(const Vector& axis, double angle, const Vector& position = {}) {
  return {position, std::sin(0.5 * angle) * normalized(axis), std::cos(0.5 * angle)};
}

}  // namespace cycloid::oracle
