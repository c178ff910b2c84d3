#include "tests/properties/generate.hpp"

#include <iterator>

namespace cycloid::properties {

/// A number from 0 to `count` - 1 whatever the size of the case; shrinks to 0.
static rc::Gen<std::uint32_t> choice(std::uint32_t count) {
  return rc::gen::resize(rc::kNominalSize, rc::gen::inRange<std::uint32_t>(0, count));
}

/// -100 to 100; shrinks to 0 from either side.
static rc::Gen<int> number() {
  return rc::gen::map(choice(201), [](std::uint32_t n) {
    const int half = static_cast<int>((n + 1) / 2);
    return n % 2 == 0 ? -half : half;
  });
}

static rc::Gen<Op> op() {
  // How often each: what makes things and time comes more often, what ends them less.
  static constexpr Op kOps[] = {
      Op::kStep,           Op::kCreateBody,   Op::kRevisit,        Op::kStep,
      Op::kStep,           Op::kStep,         Op::kStep,           Op::kCreateBody,
      Op::kCreateBody,     Op::kCreateBody,   Op::kCreateBody,     Op::kRevisit,
      Op::kRevisit,        Op::kRevisit,      Op::kRevisit,        Op::kCreateGrid,
      Op::kDestroyBody,    Op::kDestroyBody,  Op::kSetPose,        Op::kSetVelocity,
      Op::kForce,          Op::kTorque,       Op::kImpulse,        Op::kAngularImpulse,
      Op::kGravity,        Op::kGravityScale, Op::kDamping,        Op::kMass,
      Op::kMaterial,       Op::kFilter,       Op::kCreateJoint,    Op::kCreateJoint,
      Op::kCreateJoint,    Op::kCreateJoint,  Op::kDestroyJoint,   Op::kMotor,
      Op::kTarget,         Op::kSteering,     Op::kAnchor,         Op::kLimits,
      Op::kSpring,         Op::kTuning,       Op::kCreateParticle, Op::kCreateParticle,
      Op::kCreateParticle, Op::kCreateLink,   Op::kCreateLink,     Op::kDestroyParticle,
      Op::kDestroyLink,    Op::kCreatePin,    Op::kCreatePin,      Op::kDestroyPin,
      Op::kRegisters};
  return rc::gen::map(choice(static_cast<std::uint32_t>(std::size(kOps))),
                      [](std::uint32_t i) { return kOps[i]; });
}

static rc::Gen<Command> command() {
  return rc::gen::construct<Command>(op(), choice(64), choice(64),
                                     rc::gen::container<std::array<int, 8>>(number()));
}

static rc::Gen<Setting> setting() {
  return rc::gen::construct<Setting>(rc::gen::element(1, 2, 3, 8), rc::gen::element(4, 1, 8, 16),
                                     rc::gen::element(0, 1, 3, 12));
}

/// Of `tuning_of`, half of them of the default method, the last of its nine.
static rc::Gen<std::uint32_t> tuning() {
  return rc::gen::map(choice(2 * 1152),
                      [](std::uint32_t n) { return n < 1152 ? n : (n - 1152) / 9 * 9 + 8; });
}

rc::Gen<Case> cases(int dimension) {
  return rc::gen::construct<Case>(
      rc::gen::just(dimension), tuning(), choice(3),
      rc::gen::map(choice(12), [](std::uint32_t g) { return int(g); }), setting(), setting(),
      rc::gen::scale(2.0, rc::gen::container<std::vector<Command>>(command())));
}

}  // namespace cycloid::properties
