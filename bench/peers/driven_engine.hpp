#pragma once

#include <deque>
#include <vector>

#include "bench/peers/engine.hpp"

namespace cycloid::peers {

/// A peer whose bodies and joints the seats of a scene act on, as `scenes::apply_controls` lets
/// them act on our world. Characters are not there.
template <int D>
class DrivenEngine : public Engine<D> {
 public:
  explicit DrivenEngine(const scenes::Built<D>& built);
  void step(std::span<const scenes::SeatInput> inputs) final;

 protected:
  virtual void advance() = 0;  ///< One tick.
  virtual void push(std::uint32_t body, const solver::Vec<D>& force_n) = 0;
  virtual void kick(std::uint32_t body, const solver::Vec<D>& impulse_n_s) = 0;
  virtual void turn(std::uint32_t body, const solver::Spin<D>& torque_n_m) = 0;
  /// Where the engine has no such joint, nothing happens.
  virtual void set_motor_speed(std::uint32_t joint, float speed) = 0;
  virtual void set_steering(std::uint32_t joint, float angle) = 0;
  /// @param made  a state in which body 0 is the new one, and nothing else is.
  /// @returns what names the new body to `remove_spawned`.
  virtual std::size_t spawn(const solver::WorldState<D>& made) = 0;
  virtual void remove_spawned(std::size_t number) = 0;

 private:
  void apply(const scenes::BoundControl& bound, float amount, bool pressed,
             std::deque<std::size_t>& spawned);
  std::size_t spawn_prefab(const scenes::BoundControl& bound);

  std::vector<scenes::BoundSeat> seats_;
  std::vector<scenes::Prefab<D>> prefabs_;
  std::vector<solver::Material> materials_;
  std::vector<std::uint16_t> buttons_;  ///< Of each seat in the tick before.
  /// What each control of each seat has made, oldest first.
  std::vector<std::vector<std::deque<std::size_t>>> spawned_;
};

}  // namespace cycloid::peers
