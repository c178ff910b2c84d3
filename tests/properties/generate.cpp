#include "tests/properties/generate.hpp"

#include <span>

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

static std::span<const Op> any_ops() {
  // How often each: what makes things and time comes more often, what ends them less.
  static constexpr Op kOps[] = {Op::kStep,           Op::kCreateBody,     Op::kRevisit,
                                Op::kStep,           Op::kStep,           Op::kStep,
                                Op::kStep,           Op::kCreateBody,     Op::kCreateBody,
                                Op::kCreateBody,     Op::kCreateBody,     Op::kRevisit,
                                Op::kRevisit,        Op::kRevisit,        Op::kRevisit,
                                Op::kCreateGrid,     Op::kCreateChain,    Op::kCreateChain,
                                Op::kStep,           Op::kDestroyBody,    Op::kDestroyBody,
                                Op::kSetPose,        Op::kSetVelocity,    Op::kForce,
                                Op::kTorque,         Op::kImpulse,        Op::kAngularImpulse,
                                Op::kGravity,        Op::kGravityScale,   Op::kDamping,
                                Op::kMass,           Op::kMaterial,       Op::kFilter,
                                Op::kCreateJoint,    Op::kCreateJoint,    Op::kCreateJoint,
                                Op::kCreateJoint,    Op::kDestroyJoint,   Op::kMotor,
                                Op::kTarget,         Op::kSteering,       Op::kAnchor,
                                Op::kLimits,         Op::kSpring,         Op::kTuning,
                                Op::kCreateParticle, Op::kCreateParticle, Op::kCreateParticle,
                                Op::kCreateLink,     Op::kCreateLink,     Op::kDestroyParticle,
                                Op::kDestroyLink,    Op::kCreatePin,      Op::kCreatePin,
                                Op::kDestroyPin,     Op::kRegisters,      Op::kCreateLand,
                                Op::kCreateSolid,    Op::kCreateSolid,    Op::kCreateCloth,
                                Op::kCreateDrive,    Op::kCreateDrive,    Op::kSurface};
  return kOps;
}

/// The same where chains are most of what moves, so that islands that are solved at once have all.
static std::span<const Op> ops_of_chains() {
  static constexpr Op kOps[] = {
      Op::kStep,    Op::kCreateChain, Op::kRevisit, Op::kStep,        Op::kStep,
      Op::kStep,    Op::kStep,        Op::kStep,    Op::kRevisit,     Op::kRevisit,
      Op::kRevisit, Op::kTuning,      Op::kTuning,  Op::kDestroyBody, Op::kDestroyJoint,
      Op::kSetPose, Op::kSetVelocity, Op::kForce,   Op::kImpulse,     Op::kMass,
      Op::kGravity, Op::kCreateJoint, Op::kDamping, Op::kCreateBody};
  return kOps;
}

/// The same where few bodies, jointed anyhow, are put into one another and thrown: what turns fast
/// or is torn reaches the ends of what float can hold, where lanes have parted.
static std::span<const Op> ops_of_throws() {
  static constexpr Op kOps[] = {
      Op::kStep,        Op::kCreateBody, Op::kCreateJoint, Op::kSetPose,    Op::kSetVelocity,
      Op::kCreateBody,  Op::kStep,       Op::kCreateBody,  Op::kSetPose,    Op::kCreateJoint,
      Op::kSetVelocity, Op::kStep,       Op::kCreateBody,  Op::kCreateGrid, Op::kRevisit,
      Op::kMass,        Op::kTuning,     Op::kMaterial,    Op::kLimits,     Op::kMotor};
  return kOps;
}

/// The same after a crowd: much time, so that it falls asleep, and little that wakes it.
static std::span<const Op> ops_of_crowds() {
  static constexpr Op kOps[] = {
      Op::kStep,       Op::kRevisit,      Op::kStep,        Op::kStep,        Op::kStep,
      Op::kStep,       Op::kStep,         Op::kStep,        Op::kStep,        Op::kStep,
      Op::kStep,       Op::kRevisit,      Op::kRevisit,     Op::kRevisit,     Op::kRevisit,
      Op::kRevisit,    Op::kCreateBody,   Op::kDestroyBody, Op::kSetPose,     Op::kSetVelocity,
      Op::kImpulse,    Op::kForce,        Op::kMass,        Op::kFilter,      Op::kTuning,
      Op::kSurface,    Op::kGravityScale, Op::kCreateJoint, Op::kCreateDrive, Op::kDestroyJoint,
      Op::kCreateLand, Op::kCreateSolid,  Op::kCreateCloth, Op::kDamping,     Op::kCreateCrowd};
  return kOps;
}

static rc::Gen<Op> op(std::span<const Op> ops) {
  return rc::gen::map(choice(static_cast<std::uint32_t>(ops.size())),
                      [ops](std::uint32_t i) { return ops[i]; });
}

static rc::Gen<Command> command(rc::Gen<Op> op) {
  return rc::gen::construct<Command>(std::move(op), choice(64), choice(64),
                                     rc::gen::container<std::array<int, 8>>(number()));
}

static rc::Gen<std::vector<Command>> commands(std::span<const Op> ops) {
  return rc::gen::scale(2.0, rc::gen::container<std::vector<Command>>(command(op(ops))));
}

/// As many whatever the size of the case, which is first small: fewer would not let it fall asleep.
static rc::Gen<std::vector<Command>> commands_on_a_crowd() {
  constexpr int kMost = 12;
  return rc::gen::apply(
      [](const Command& crowd, std::vector<Command> others) {
        others.insert(others.begin(), crowd);
        return others;
      },
      command(rc::gen::just(Op::kCreateCrowd)), rc::gen::resize(kMost, commands(ops_of_crowds())));
}

static rc::Gen<Setting> setting() {
  return rc::gen::construct<Setting>(rc::gen::element(1, 2, 3, 8), rc::gen::element(4, 1, 8, 16),
                                     rc::gen::element(0, 1, 3, 12));
}

/// Of `tuning_of`, half of them the default method in any order, sleep and warm start, whose
/// islands at once any other choice of blocks or of joints' solver would switch off.
static rc::Gen<std::uint32_t> tuning() {
  return rc::gen::map(choice(2 * 5184), [](std::uint32_t n) {
    return n < 5184 ? n : 8 + 9 * (n % 4) + 9 * 4 * 3 * 2 * (n / 4 % 12);
  });
}

/// Of those that let bodies sleep, at once or soon; every other with the default method.
static rc::Gen<std::uint32_t> tuning_of_crowds() {
  return rc::gen::map(choice(72), [](std::uint32_t n) {
    const std::uint32_t method = n % 2 == 0 ? 8 : n / 2 % 9;
    return method + 9 * 4 * 3 * 2 * (n / 36);
  });
}

static rc::Gen<int> gravity(std::uint32_t least) {
  return rc::gen::map(choice(12 - least), [least](std::uint32_t g) { return int(g + least); });
}

rc::Gen<Case> cases(int dimension, bool crowds) {
  const auto on_any_ground = [dimension](rc::Gen<std::vector<Command>> commands) {
    return rc::gen::construct<Case>(rc::gen::just(dimension), tuning(), choice(3), gravity(0),
                                    setting(), setting(), std::move(commands));
  };
  return rc::gen::weightedOneOf<Case>(
      {{17, on_any_ground(commands(any_ops()))},
       {6, on_any_ground(commands(ops_of_chains()))},
       {6, on_any_ground(commands(ops_of_throws()))},
       {crowds ? 1u : 0u,
        rc::gen::construct<Case>(rc::gen::just(dimension), tuning_of_crowds(), choice(3),
                                 gravity(8), setting(), setting(), commands_on_a_crowd())}});
}

}  // namespace cycloid::properties
