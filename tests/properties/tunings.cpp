#include <iterator>

#include "tests/properties/definitions.hpp"

namespace cycloid::properties {

using solver::Tuning;

Tuning tuning_of(std::uint32_t choice) {
  const Tuning methods[] = {
      Tuning::soft_step(),     Tuning::pgs(),           Tuning::xpbd(),
      Tuning::split_impulse(), Tuning::pgs_ngs(),       Tuning::tgs_ngs(),
      Tuning::pgs_soft(),      Tuning::pgs_ngs_block(), Tuning::soft_loaded()};
  Tuning tuning = methods[choice % 9];
  choice /= 9;
  if (choice % 4 == 1) tuning.order = solver::Order::kId;
  if (choice % 4 == 2) tuning.order = solver::Order::kReverse;
  choice /= 4;
  if (choice % 3 == 1) tuning.contact_block = solver::ContactBlockRows::kNormals;
  if (choice % 3 == 2) tuning.contact_block = solver::ContactBlockRows::kNormalFriction;
  choice /= 3;
  if (choice % 2 == 1) tuning.joint_solver = solver::JointSolver::kDirect;
  choice /= 2;
  // A twentieth of a second, so that short cases sleep too.
  const float sleeps_s[] = {0.05f, 0.5f, 0.0f};
  tuning.sleep_s = sleeps_s[choice % 3];
  if (choice % 3 == 0) tuning.sleep_speed = 0.5f;
  choice /= 3;
  tuning.continuous = 1 - choice % 2;
  choice /= 2;
  if (choice % 2 == 1) tuning.warm_starting = 0.7f;
  choice /= 2;
  if (choice % 2 == 1 && tuning.stabilisation == solver::Stabilisation::kSoft)
    tuning.contact_block = solver::ContactBlockRows::kIsland;
  tuning.particle_substeps = 6;
  return tuning;
}

/// One number of a tuning; `share` is 0.1 to 2.
static void change_value(std::uint32_t which, float share, Tuning& tuning) {
  float* const values[] = {&tuning.slop,
                           &tuning.speculative_distance,
                           &tuning.sleep_speed,
                           &tuning.restitution_threshold,
                           &tuning.contact_hertz,
                           &tuning.joint_hertz,
                           &tuning.push_speed_max,
                           &tuning.contact_damping_ratio,
                           &tuning.particle_damping};
  constexpr float kMost[] = {0.02f, 0.1f, 0.5f, 3.0f, 60.0f, 90.0f, 5.0f, 12.0f, 4.0f};
  if (which < std::size(values))
    *values[which] = share * kMost[which];
  else
    tuning.continuous = 1 - tuning.continuous;
}

Tuning tuning_after(const Tuning& now, const Command& command) {
  const Tuning other = tuning_of(command.a + 64 * command.b);
  if (command.b % 2 == 0) return other;
  Tuning changed = now;
  switch (command.b / 2 % 16) {
    case 0:
      changed.order = static_cast<solver::Order>(command.a % 3);
      break;
    case 1:
      changed.substeps = 1 + command.a % 8;
      break;
    case 2:
      changed.contact_block = other.contact_block;
      break;
    case 3:
      changed.joint_solver = other.joint_solver;
      break;
    case 4:
      changed.sleep_s = other.sleep_s;
      break;
    case 5:
      changed.warm_starting = other.warm_starting;
      break;
    default:
      change_value(command.b / 2 % 16 - 6, 0.1f + 0.03f * static_cast<float>(command.a), changed);
  }
  return changed;
}

}  // namespace cycloid::properties
