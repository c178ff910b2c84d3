#pragma once

#include <memory>
#include <span>

#include "scenes/build.hpp"
#include "solver/collision/manifold.hpp"

namespace cycloid::peers {

/// A scene of space in Bullet 3.24, as the distribution packages it, with Bullet's own defaults:
/// one step of ten iterations per tick. Bodies, shapes, joints and controls are those of the built
/// scene at tick 0. Friction mixes alike in both (Bullet multiplies, so it is given the roots).
///
/// Approximations: a wheel joint is Bullet's Hinge2; the friction of a cone-twist joint is left
/// out; cloths, characters and the damping of mass-less things are not there.
class BulletWorld {
 public:
  /// @param sleep  whether bodies at rest are put to sleep.
  BulletWorld(const scenes::Built<3>& built, bool sleep);
  ~BulletWorld();

  /// Applies the controls of every seat, then steps one tick.
  void step(std::span<const scenes::SeatInput> inputs);

  /// Of a body of the built scene, by slot: centre of mass, world.
  solver::Pose<3> pose(std::uint32_t body) const;

  /// Bytes that Bullet holds now, of all worlds of this process.
  static std::size_t bytes();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace cycloid::peers
