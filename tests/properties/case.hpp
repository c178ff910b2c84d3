#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <vector>

namespace cycloid::properties {

/// What is done to a world. Simple ones first: a failing case shrinks towards them.
enum class Op : std::uint8_t {
  kStep,
  kCreateBody,
  kRevisit,  ///< Only the second run: the state is saved and comes back, see `Revisit`.
  kCreateGrid,
  kCreateChain,
  kDestroyBody,
  kSetPose,
  kSetVelocity,
  kForce,
  kTorque,
  kImpulse,
  kAngularImpulse,
  kGravity,
  kGravityScale,
  kDamping,
  kMass,
  kMaterial,
  kFilter,
  kCreateJoint,
  kDestroyJoint,
  kMotor,
  kTarget,
  kSteering,
  kAnchor,
  kLimits,
  kSpring,
  kTuning,
  kCreateParticle,
  kDestroyParticle,
  kCreateLink,
  kDestroyLink,
  kCreatePin,
  kDestroyPin,
  kRegisters,
  kCreateCrowd,  ///< More bodies in one place than one worker takes at once; with a floor.
  kCreateLand,   ///< What only static bodies have, anywhere.
  kCreateSolid,  ///< Shapes and settings that no other command makes.
  kCreateCloth,  ///< A rope or a cloth: particles, links and perhaps a pin.
  kCreateDrive,  ///< A joint with settings that kCreateJoint does not make.
  kSurface,      ///< A material with all its values good.
  kCount,
};

/// How the second run is disturbed; none of these may show. Command::b modulo kCount.
enum class Revisit : std::uint8_t {
  kMemory,        ///< Saved and restored at once.
  kBytes,         ///< Encoded and decoded into the same world.
  kFreshWorld,    ///< Encoded, and decoded into a world that was just made.
  kAfterAnother,  ///< Saved; steps on and loses bodies; restored.
  kMove,          ///< The world moves to another place.
  kSettings,      ///< Other workers, lanes and lots from now on.
  kStranger,      ///< From now on another world steps in between.
  kLook,          ///< Every const call.
  kTrim,          ///< Memory is given back; workers rest, or no longer do.
  kTraced,        ///< From now on, or no longer, steps are traced.
  kAfterEdits,    ///< Saved; other commands; restored.
  kTwin,          ///< Saved, and restored into a world that has been it before, if there is one.
  kReplay,        ///< Back to where this was asked before, and all again since then.
  kCount,
};

/// One call, in integers that make sense whatever came before: `a` and `b` choose among what is
/// alive, modulo its number, so that a case from which commands are taken away is still a case.
struct Command {
  Op op = Op::kStep;
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  std::array<int, 8> v{};
};

struct Setting {
  int workers = 1;
  int lanes = 4;
  int lot_contacts = 0;
};

/// A scene and all that happens to it, played in two settings.
struct Case {
  int dimension = 2;
  std::uint32_t tuning = 0;  ///< See `tuning_of`.
  std::uint32_t ground = 0;  ///< 0: none; see `ground_of`.
  int gravity = 0;           ///< m/s^2 downwards.
  Setting one;
  Setting other;
  std::vector<Command> commands;
};

/// As C++ that makes the case again, with a remark what each command does.
std::ostream& operator<<(std::ostream& out, const Case& example);

}  // namespace cycloid::properties
