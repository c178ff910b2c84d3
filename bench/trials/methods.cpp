#include "bench/trials/methods.hpp"

#include <array>

#include "scenes/accuracy.hpp"

namespace cycloid::trials {

using solver::Tuning;

static Tuning coupled() {
  Tuning tuning = Tuning::soft_step();
  tuning.contact_block = solver::ContactBlockRows::kNormalFriction;
  return tuning;
}

static Tuning direct() {
  Tuning tuning = Tuning::soft_step();
  tuning.joint_solver = solver::JointSolver::kDirect;
  return tuning;
}

static Tuning islands() {
  Tuning tuning = Tuning::soft_step();
  tuning.contact_block = solver::ContactBlockRows::kIsland;
  return tuning;
}

std::span<const Method> methods() {
  static const std::array<Method, 12> kMethods = {{
      {"soft-step", Tuning::soft_step()},
      {"soft-loaded", Tuning::soft_loaded()},
      {"soft-direct", direct()},
      {"soft-coupled", coupled()},
      {"soft-islands", islands()},
      {"pgs", Tuning::pgs()},
      {"split-impulse", Tuning::split_impulse()},
      {"ngs", Tuning::pgs_ngs()},
      {"ngs-block", Tuning::pgs_ngs_block()},
      {"pgs-soft", Tuning::pgs_soft()},
      {"tgs-ngs", Tuning::tgs_ngs()},
      {"xpbd", Tuning::xpbd()},
  }};
  return kMethods;
}

Tuning with_method(const Tuning& scene, const Tuning& method) {
  Tuning tuning = scenes::solved_by(scene, method);
  tuning.slop = scene.slop;
  return tuning;
}

}  // namespace cycloid::trials
