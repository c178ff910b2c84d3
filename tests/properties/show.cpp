#include <ostream>

#include "tests/properties/scenery.hpp"

namespace cycloid::properties {

static constexpr const char* kOpNames[] = {
    "Step",        "CreateBody",     "Revisit",        "CreateGrid",      "CreateChain",
    "DestroyBody", "SetPose",        "SetVelocity",    "Force",           "Torque",
    "Impulse",     "AngularImpulse", "Gravity",        "GravityScale",    "Damping",
    "Mass",        "Material",       "Filter",         "CreateJoint",     "DestroyJoint",
    "Motor",       "Target",         "Steering",       "Anchor",          "Limits",
    "Spring",      "Tuning",         "CreateParticle", "DestroyParticle", "CreateLink",
    "DestroyLink", "CreatePin",      "DestroyPin",     "Registers",       "CreateCrowd",
    "CreateLand",  "CreateSolid",    "CreateCloth",    "CreateDrive",     "Surface"};
static_assert(std::size(kOpNames) == static_cast<std::size_t>(Op::kCount));

static constexpr const char* kRevisitNames[] = {"saved and restored",
                                                "encoded and decoded",
                                                "decoded into a new world",
                                                "restored after other ticks",
                                                "moved",
                                                "other workers, lanes and lots",
                                                "a stranger beside it",
                                                "looked at",
                                                "trimmed, workers at rest",
                                                "traced",
                                                "restored after other commands",
                                                "restored into its twin",
                                                "replayed"};
static_assert(std::size(kRevisitNames) == static_cast<std::size_t>(Revisit::kCount));

template <int D>
static void remark_on_body(const Piece<D>& piece, std::ostream& out) {
  constexpr const char* kKinds[] = {"free", "static", "kinematic", "dynamic", "particle"};
  out << kKinds[static_cast<std::size_t>(piece.body.kind)] << " of " << piece.shapes.size()
      << " shapes at";
  for (const float value : piece.body.position.v) out << ' ' << value;
}

/// Of what is made in one dimension as in the other, or not quite.
template <int D>
static void remark_in(const Command& command, std::ostream& out) {
  switch (command.op) {
    case Op::kCreateBody:
      return remark_on_body(piece_of<D>(command), out);
    case Op::kCreateLand:
      return remark_on_body(land_of<D>(command), out);
    case Op::kCreateSolid:
      return remark_on_body(solid_of<D>(command), out);
    case Op::kCreateGrid:
      out << grid_of<D>(command).size() << " bodies";
      return;
    case Op::kCreateCrowd:
      out << crowd_of<D>(command).size() << " bodies";
      return;
    case Op::kCreateChain:
      out << chain_of<D>(command).size() << " bodies";
      return;
    default: {
      const Cloth<D> cloth = cloth_of<D>(command);
      out << cloth.particles.size() << " particles with " << cloth.links.size() << " links";
    }
  }
}

static void remark(const Case& example, const Command& command, std::ostream& out) {
  switch (command.op) {
    case Op::kStep:
      out << 1 + command.a % 12 << " ticks";
      return;
    case Op::kCreateBody:
    case Op::kCreateLand:
    case Op::kCreateSolid:
    case Op::kCreateGrid:
    case Op::kCreateCrowd:
    case Op::kCreateChain:
    case Op::kCreateCloth:
      if (example.dimension == 2) remark_in<2>(command, out);
      if (example.dimension == 3) remark_in<3>(command, out);
      return;
    case Op::kCreateJoint:
      out << name_of(joint_of<2>(command).kind) << " of bodies " << command.a << " and "
          << command.b << " modulo those alive";
      return;
    case Op::kCreateDrive:
      out << name_of(
                 (example.dimension == 2 ? drive_of<2>(command).kind : drive_of<3>(command).kind))
          << " of bodies " << command.a << " and " << command.b << " modulo those alive";
      return;
    case Op::kRevisit:
      out << kRevisitNames[command.b % std::size(kRevisitNames)];
      return;
    case Op::kTuning:
      out << (command.b % 2 == 0 ? "another tuning" : "one thing of the tuning");
      return;
    default:
      out << "of number " << command.a << " modulo those alive";
  }
}

std::ostream& operator<<(std::ostream& out, const Case& example) {
  const auto setting = [&](const Setting& of) {
    out << '{' << of.workers << ", " << of.lanes << ", " << of.lot_contacts << "}, ";
  };
  out << "Case{" << example.dimension << ", " << example.tuning << ", " << example.ground << ", "
      << example.gravity << ", ";
  setting(example.one);
  setting(example.other);
  out << "{\n";
  for (const Command& command : example.commands) {
    out << "    {Op::k" << kOpNames[static_cast<std::size_t>(command.op)] << ", " << command.a
        << ", " << command.b << ", {";
    for (std::size_t i = 0; i < command.v.size(); ++i) out << (i == 0 ? "" : ", ") << command.v[i];
    out << "}},  // ";
    remark(example, command, out);
    out << '\n';
  }
  return out << "}}";
}

}  // namespace cycloid::properties
