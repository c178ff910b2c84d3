#include "bench/peers/driven_engine.hpp"

namespace cycloid::peers {

using scenes::Effect;

template <int D>
DrivenEngine<D>::DrivenEngine(const scenes::Built<D>& built)
    : seats_(built.seats),
      prefabs_(built.prefabs),
      materials_(built.world.state().materials),
      buttons_(built.seats.size()) {
  for (const scenes::BoundSeat& seat : seats_) spawned_.emplace_back(seat.controls.size());
}

static float level(const scenes::Control& control, const scenes::SeatInput& input) {
  if (control.source == scenes::Source::kAxis)
    return static_cast<float>(input.axes[control.index]) / 32767.0f;
  return (input.buttons >> control.index & 1u) != 0 ? 1.0f : 0.0f;
}

template <int N>
static solver::Vec<N> scaled(const scenes::Triple& value, float by) {
  solver::Vec<N> result;
  for (int i = 0; i < N; ++i) result[i] = by * value[static_cast<std::size_t>(i)];
  return result;
}

template <int D>
void DrivenEngine<D>::apply(const scenes::BoundControl& bound, float amount, bool pressed,
                            std::deque<std::size_t>& spawned) {
  const scenes::Control& control = bound.control;
  switch (control.effect) {
    case Effect::kForce:
      if (amount != 0.0f) push(bound.body.index, scaled<D>(control.value, amount));
      break;
    case Effect::kTorque:
      if (amount != 0.0f)
        turn(bound.body.index, scaled<solver::Dim<D>::kSpin>(control.value, amount));
      break;
    case Effect::kImpulse:
      if (pressed) kick(bound.body.index, scaled<D>(control.value, 1.0f));
      break;
    case Effect::kMotorSpeed:
      set_motor_speed(bound.joint.index, amount * control.value[0]);
      break;
    case Effect::kSteering:
      set_steering(bound.joint.index, amount * control.value[0]);
      break;
    case Effect::kSpawn:
      if (!pressed) break;
      if (spawned.size() == control.limit) {
        remove_spawned(spawned.front());
        spawned.pop_front();
      }
      spawned.push_back(spawn_prefab(bound));
      break;
    default:
      break;
  }
}

template <int D>
std::size_t DrivenEngine<D>::spawn_prefab(const scenes::BoundControl& bound) {
  // Its mass and shapes come from a world of its own, where it is body 0.
  solver::WorldDef<D> empty;
  empty.materials = materials_;
  auto world = solver::World<D>::create(empty);
  solver::BodyDef<D> def = prefabs_[bound.prefab].body;
  def.position = scaled<D>(bound.control.position, 1.0f);
  def.velocity = scaled<D>(bound.control.velocity, 1.0f);
  (void)world.value().create_body(def, prefabs_[bound.prefab].shapes);
  return spawn(world.value().state());
}

template <int D>
void DrivenEngine<D>::step(std::span<const scenes::SeatInput> inputs) {
  for (std::size_t seat = 0; seat < inputs.size(); ++seat) {
    const auto fresh = static_cast<std::uint16_t>(inputs[seat].buttons & ~buttons_[seat]);
    buttons_[seat] = inputs[seat].buttons;
    for (std::size_t i = 0; i < seats_[seat].controls.size(); ++i) {
      const scenes::BoundControl& bound = seats_[seat].controls[i];
      const bool pressed = bound.control.source == scenes::Source::kButton &&
                           (fresh >> bound.control.index & 1) != 0;
      apply(bound, level(bound.control, inputs[seat]), pressed, spawned_[seat][i]);
    }
  }
  advance();
}

template class DrivenEngine<2>;
template class DrivenEngine<3>;

}  // namespace cycloid::peers
