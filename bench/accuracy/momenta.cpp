#include <cmath>

#include "bench/accuracy/observer.hpp"

namespace cycloid::accuracy {

using Numbers = std::array<double, 3>;

static Numbers cross(const Numbers& a, const Numbers& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <int D>
static Numbers numbers_of(const solver::Vec<D>& vector) {
  Numbers numbers{};
  for (int i = 0; i < D; ++i) numbers[static_cast<std::size_t>(i)] = static_cast<double>(vector[i]);
  return numbers;
}

/// Own angular momentum of a body as a vector of space.
static Numbers spin_momentum(const solver::Body<2>& body) {
  return {0.0, 0.0, trials::momentum_of(body)[0]};
}
static Numbers spin_momentum(const solver::Body<3>& body) {
  return trials::momentum_of(body);
}

static void add(double factor, const Numbers& from, Numbers& to) {
  for (std::size_t i = 0; i < 3; ++i) to[i] += factor * from[i];
}

template <int D>
Momenta momenta_of(const solver::WorldState<D>& state) {
  Momenta momenta;
  Numbers centre{};
  double mass = 0.0;
  for (const solver::Body<D>& body : state.bodies) {
    if (!trials::responds(body)) continue;
    add(static_cast<double>(body.mass), numbers_of(body.position), centre);
    add(static_cast<double>(body.mass), numbers_of(body.velocity), momenta.linear);
    mass += static_cast<double>(body.mass);
  }
  if (mass == 0.0) return momenta;
  for (double& number : centre) number /= mass;
  for (const solver::Body<D>& body : state.bodies) {
    if (!trials::responds(body)) continue;
    Numbers from_centre = numbers_of(body.position);
    add(-1.0, centre, from_centre);
    // Relative to the common velocity, whose moment about the centre is 0 but for rounding.
    Numbers velocity = numbers_of(body.velocity);
    momenta.linear_size += static_cast<double>(body.mass) * trials::distance(velocity, {});
    add(-1.0 / mass, momenta.linear, velocity);
    Numbers angular = spin_momentum(body);
    add(static_cast<double>(body.mass), cross(from_centre, velocity), angular);
    add(1.0, angular, momenta.angular);
    momenta.angular_size += trials::distance(angular, {});
  }
  return momenta;
}

template Momenta momenta_of(const solver::WorldState<2>&);
template Momenta momenta_of(const solver::WorldState<3>&);

}  // namespace cycloid::accuracy
