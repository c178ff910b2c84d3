#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::protocol::states {

using Encoding = std::vector<std::byte>;

/// A catalogue scene that plays its own script, or one that chance presses every key of.
class Played {
 public:
  explicit Played(const std::string& name)
      : scene_(std::move(*scenes::find(name).scene)),
        simulation_(std::move(scenes::Simulation::create(scene_).value())) {}

  void step(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      std::vector<scenes::SeatInput> inputs;
      for (int seat = 0; seat < simulation_.seats(); ++seat)
        inputs.push_back(scenes::scripted_input(scene_, seat, simulation_.tick() + 1));
      ASSERT_TRUE(simulation_.step(inputs).ok()) << scene_.name;
    }
  }

  /// Nobody touches anything.
  void idle(int ticks) {
    const std::vector<scenes::SeatInput> inputs(static_cast<std::size_t>(simulation_.seats()));
    for (int i = 0; i < ticks; ++i) ASSERT_TRUE(simulation_.step(inputs).ok()) << scene_.name;
  }

  /// Buttons go down and up, so that scenes with a ring of balls make and destroy bodies.
  void step_wildly(std::mt19937& random) {
    std::vector<scenes::SeatInput> inputs(static_cast<std::size_t>(simulation_.seats()));
    for (scenes::SeatInput& input : inputs) {
      for (std::int16_t& axis : input.axes) axis = static_cast<std::int16_t>(random());
      input.buttons = static_cast<std::uint16_t>(random() % 2 == 0 ? 0xffff : 0);
    }
    ASSERT_TRUE(simulation_.step(inputs).ok()) << scene_.name;
  }

  /// Every cube, ball or limb at once: `speed` in a direction of its own.
  void kick_all(float speed, std::mt19937& random) {
    solver::World<3>* world = simulation_.spatial();
    ASSERT_NE(world, nullptr);
    auto any = [&] { return static_cast<float>(random() % 2001) / 1000.0f - 1.0f; };
    for (const solver::BodyView<3>& body : world->bodies())
      if (body.kind == solver::BodyKind::kDynamic) {
        const float mass = body.mass;
        ASSERT_TRUE(world
                        ->apply_impulse(
                            body.id, {{mass * speed * any(), mass * speed, mass * speed * any()}})
                        .ok());
      }
  }

  Encoding encoding() const {
    Encoding bytes;
    simulation_.encode(bytes);
    return bytes;
  }
  const scenes::Scene& scene() const { return scene_; }
  scenes::Simulation& simulation() { return simulation_; }
  const scenes::Simulation& simulation() const { return simulation_; }

 private:
  scenes::Scene scene_;
  scenes::Simulation simulation_;
};

/// Scenes of every sort of record: boxes and hulls, curves, joints, characters, particles with
/// links and pins, bodies that come and go.
inline const std::vector<std::string>& names() {
  static const std::vector<std::string> kNames = {
      "half-pipe", "pyramid-20", "room-200",         "ragdolls-3d", "character-course-3d",
      "cloth",     "vehicle-3d", "character-course", "machines",    "overlap"};
  return kNames;
}

}  // namespace cycloid::protocol::states
