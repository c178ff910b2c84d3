#include "tests/properties/definitions.hpp"

#include "solver/constraints/rows.hpp"

namespace cycloid::properties {

using solver::BodyKind;
using solver::JointKind;
using solver::ShapeDef;
using solver::ShapeKind;
using solver::Vec;

/// No power of two, so that sums round.
static float scaled(int value) {
  return 0.07f * static_cast<float>(value);
}

float size_of(int value) {
  const int magnitude = value < 0 ? -value : value;
  return 0.1f + 0.013f * static_cast<float>(magnitude);
}

float number_of(const Command& command, std::size_t index) {
  return scaled(command.v[index]);
}

template <int D>
Vec<D> vector_of(const Command& command, std::size_t first) {
  Vec<D> vector = Vec<D>::zero();
  for (std::size_t i = 0; i < std::size_t{D}; ++i)
    vector[static_cast<int>(i)] = scaled(command.v[(first + i) % command.v.size()]);
  return vector;
}

template <int D>
solver::Spin<D> spin_of(const Command& command, std::size_t first) {
  solver::Spin<D> spin = solver::Spin<D>::zero();
  for (int i = 0; i < solver::Dim<D>::kSpin; ++i)
    spin[i] = scaled(command.v[(first + static_cast<std::size_t>(i)) % command.v.size()]);
  return spin;
}

template <int D>
solver::Rotation<D> rotation_of(int value) {
  solver::Rotation<D> rotation = solver::identity_rotation<D>();
  // Some turn that is no nice angle; its length is made 1.
  for (int i = 0; i < solver::Dim<D>::kRotation; ++i)
    rotation[i] += 0.03f * static_cast<float>(value % (7 + 4 * i));
  return solver::normalized_or(rotation, solver::identity_rotation<D>());
}

template <int D>
solver::WorldDef<D> world_of(const Case& example) {
  solver::WorldDef<D> def;
  def.gravity[1] = -1.01f * static_cast<float>(example.gravity);
  def.tuning = tuning_of(example.tuning);
  def.materials = {{}, {0.0f, 0.8f, 0.0f, 0.0f}, {1.1f, 0.1f, 0.05f, 0.02f}};
  def.limits.bodies = 300;
  def.limits.registers = 16;
  return def;
}

ShapeDef<2> box_of(const Vec<2>& half) {
  ShapeDef<2> shape;
  shape.kind = ShapeKind::kPolygon;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
    shape.points.push_back({{static_cast<float>(x) * half[0], static_cast<float>(y) * half[1]}});
  return shape;
}
ShapeDef<3> box_of(const Vec<3>& half) {
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kBox;
  shape.half = half;
  return shape;
}

/// A corner polygon or a hull of uneven corners.
static ShapeDef<2> uneven(ShapeDef<2> shape, float size) {
  shape.kind = ShapeKind::kPolygon;
  shape.points = {{{-size, -0.7f * size}}, {{1.1f * size, -0.5f * size}}, {{0.2f * size, size}}};
  shape.radius = 0.05f;
  return shape;
}
static ShapeDef<3> uneven(ShapeDef<3> shape, float size) {
  shape.kind = ShapeKind::kHull;
  for (int corner = 0; corner < 8; ++corner) {
    const float stretch = 1.0f + 0.06f * static_cast<float>(corner);
    shape.points.push_back(
        {{(corner & 1) != 0 ? stretch * size : -size, (corner & 2) != 0 ? size : -stretch * size,
          (corner & 4) != 0 ? size : -size}});
  }
  return shape;
}

ShapeDef<2> land(ShapeDef<2> shape) {
  shape.kind = ShapeKind::kChain;
  for (int i = 0; i < 12; ++i)
    shape.points.push_back(
        {{12.0f - 2.1f * static_cast<float>(i), 0.3f * static_cast<float>(i * i % 5)}});
  return shape;
}
ShapeDef<3> land(ShapeDef<3> shape) {
  shape.kind = ShapeKind::kHeightField;
  shape.columns = 8;
  shape.cell = {2.7f, 2.9f};
  shape.points = {{{-9.0f, 0.0f, -9.0f}}};
  for (int i = 0; i < 56; ++i) shape.heights.push_back(0.2f * static_cast<float>(i * i % 7));
  return shape;
}

template <int D>
static ShapeDef<D> half_space() {
  ShapeDef<D> shape;
  shape.kind = ShapeKind::kHalfSpace;
  shape.normal[1] = 1.0f;
  return shape;
}

template <int D>
Piece<D> ground_of(std::uint32_t choice) {
  Piece<D> piece;
  piece.body.kind = BodyKind::kStatic;
  if (choice % 3 == 1) piece.shapes.push_back(half_space<D>());
  if (choice % 3 == 2) piece.shapes.push_back(land(ShapeDef<D>{}));
  return piece;
}

template <int D>
static std::vector<ShapeDef<D>> shapes_of(std::uint32_t sort, float size) {
  ShapeDef<D> ball;
  ball.radius = size;
  ShapeDef<D> capsule = ball;
  capsule.kind = ShapeKind::kCapsule;
  Vec<D> end = Vec<D>::zero();
  end[0] = size;
  end[1] = 0.5f * size;
  capsule.points = {-end, end};
  Vec<D> half = Vec<D>::zero();
  for (int i = 0; i < D; ++i) half[i] = size + 0.11f * static_cast<float>(i);
  switch (sort % 6) {
    case 0:
      return {ball};
    case 1:
      return {box_of(half)};
    case 2:
      return {capsule};
    case 3:
      return {uneven(ShapeDef<D>{}, size)};
    case 4:
      ball.points = {end};
      return {box_of(half), ball};
    default:
      return {};
  }
}

template <int D>
Piece<D> piece_of(const Command& command) {
  constexpr BodyKind kKinds[] = {BodyKind::kDynamic,   BodyKind::kDynamic, BodyKind::kDynamic,
                                 BodyKind::kKinematic, BodyKind::kDynamic, BodyKind::kStatic,
                                 BodyKind::kDynamic,   BodyKind::kParticle};
  Piece<D> piece;
  piece.body.kind = kKinds[command.a % 8];
  piece.body.position = vector_of<D>(command, 0);
  piece.body.rotation = rotation_of<D>(command.v[3]);
  if (piece.body.kind != BodyKind::kStatic) {
    piece.body.velocity = vector_of<D>(command, 4);
    piece.body.spin = spin_of<D>(command, 5);
  }
  piece.body.fixed_rotation = command.a % 16 == 9;
  piece.body.linear_damping = command.a % 16 == 10 ? 0.3f : 0.0f;
  piece.shapes = shapes_of<D>(command.b, size_of(command.v[6]));
  if (piece.body.kind == BodyKind::kParticle || piece.shapes.empty()) piece.body.mass = 1.3f;
  if (piece.body.kind == BodyKind::kStatic && command.b % 8 == 7) piece.shapes = {half_space<D>()};
  for (ShapeDef<D>& shape : piece.shapes) {
    shape.material = static_cast<std::uint32_t>(command.v[7] + 200) % 3;
    if (command.b % 32 == 31) shape.filter.group = -1;
  }
  return piece;
}

template <int D>
std::vector<Piece<D>> grid_of(const Command& command) {
  const std::uint32_t columns = 2 + command.a % 7;
  const std::uint32_t rows = 2 + command.b % 7;
  std::vector<Piece<D>> pieces;
  for (std::uint32_t i = 0; i < columns * rows; ++i) {
    Piece<D> piece;
    const float size = 0.2f + 0.001f * static_cast<float>(command.v[3] + 100);
    piece.body.position = vector_of<D>(command, 0);
    piece.body.position[0] += 2.05f * size * static_cast<float>(i % columns);
    piece.body.position[1] += 2.25f * size * static_cast<float>(i / columns);
    Vec<D> half = Vec<D>::zero();
    for (int axis = 0; axis < D; ++axis) half[axis] = size;
    ShapeDef<D> shape;
    shape.radius = size;
    if ((i + command.a) % 3 != 0) shape = box_of(half);
    piece.shapes = {shape};
    pieces.push_back(piece);
  }
  return pieces;
}

template <int D>
std::vector<Piece<D>> chain_of(const Command& command) {
  Piece<D> piece;
  piece.body.kind = BodyKind::kStatic;
  piece.body.position = vector_of<D>(command, 0);
  std::vector<Piece<D>> pieces = {piece};
  piece.body.kind = BodyKind::kDynamic;
  ShapeDef<D> shape;
  shape.radius = 0.2f;
  piece.shapes = {shape};
  piece.body.mass = 1.3f;
  const std::uint32_t links = 1 + command.a % 6;
  for (std::uint32_t i = 0; i < links; ++i) {
    // Down at rest, or to the side, so that it swings.
    piece.body.position[command.a % 4 == 3 ? 0 : 1] -= 0.9f;
    if (i + 1 == links && command.b % 4 != 3) piece.body.mass = 70.0f;
    pieces.push_back(piece);
  }
  return pieces;
}

static constexpr JointKind kJointKinds[] = {
    JointKind::kRevolute, JointKind::kDistance, JointKind::kWeld,   JointKind::kPrismatic,
    JointKind::kWheel,    JointKind::kMotor,    JointKind::kTarget, JointKind::kPulley,
    JointKind::kUser,     JointKind::kGear,     JointKind::kCurve,  JointKind::kHinge,
    JointKind::kConeTwist};

template <int D>
solver::JointDef<D> joint_of(const Command& command) {
  const auto positive = [&](std::size_t i) { return size_of(command.v[i]); };
  solver::JointDef<D> def;
  def.kind = kJointKinds[static_cast<std::uint32_t>(command.v[0] + 130) % 13];
  def.anchor_a[0] = number_of(command, 1);
  def.anchor_b[1] = number_of(command, 2);
  def.axis[0] = 1.0f;
  if (D == 3 && def.kind == JointKind::kWheel) def.axle[D - 1] = 1.0f;
  def.length = positive(3);
  def.cone = 0.6f;
  def.ratio = 1.5f;
  def.ground_a[1] = 9.0f;
  def.ground_b[1] = 9.0f;
  def.size = {positive(3), positive(4)};
  def.user_kind = kShelf;
  const auto bits = static_cast<std::uint32_t>(command.v[5] + 128);
  if ((bits & 1) != 0) def.hertz = 3.0f;
  def.damping_ratio = 0.4f;
  const bool limited = def.kind != JointKind::kWeld && def.kind != JointKind::kMotor &&
                       def.kind != JointKind::kTarget && def.kind != JointKind::kGear;
  def.limit_enabled = limited && (bits & 2) != 0;
  def.lower = -0.2f;
  def.upper = 0.3f;
  if ((bits & 12) == 12) def.motor = solver::MotorKind::kSpeed;
  if ((bits & 28) == 20) def.motor = solver::MotorKind::kPosition;
  def.motor_speed = number_of(command, 6);
  def.motor_max = 40.0f;
  def.drive_amplitude = 0.2f;
  def.drive_hertz = 2.0f;
  def.force_max = 500.0f;
  def.torque_max = (bits & 32) != 0 ? 30.0f : 0.0f;
  def.collide_connected = (bits & 64) != 0;
  return def;
}

/// b's anchor stays on the plane y = 0 of a; its coordinate is x.
template <int D>
static void shelf_rows(const solver::JointFrame<D>& frame, solver::JointRows<D>& rows) {
  const Vec<D> place = rotate_back(frame.rotation_a, frame.offset);
  Vec<D> up = Vec<D>::zero();
  Vec<D> along = Vec<D>::zero();
  up[1] = 1.0f;
  along[0] = 1.0f;
  rows.rows[0] = translation_row(frame, rotate(frame.rotation_a, up));
  rows.rows[0].error = place[1];
  rows.count = 1;
  rows.split = 1;
  rows.has_axis = true;
  rows.axis = translation_row(frame, rotate(frame.rotation_a, along));
  rows.axis.error = place[0];
}

template <int D>
void register_shelf(solver::World<D>& world) {
  world.register_constraint(kShelf, &shelf_rows<D>);
}

std::string name_of(JointKind kind) {
  constexpr const char* kNames[] = {"free",  "distance", "revolute", "prismatic", "wheel",
                                    "weld",  "motor",    "target",   "gear",      "pulley",
                                    "curve", "user",     "hinge",    "cone-twist"};
  return kNames[static_cast<std::size_t>(kind)];
}

template Piece<2> ground_of(std::uint32_t);
template Piece<3> ground_of(std::uint32_t);
template Piece<2> piece_of(const Command&);
template Piece<3> piece_of(const Command&);
template std::vector<Piece<2>> grid_of(const Command&);
template std::vector<Piece<3>> grid_of(const Command&);
template std::vector<Piece<2>> chain_of(const Command&);
template std::vector<Piece<3>> chain_of(const Command&);
template solver::WorldDef<2> world_of(const Case&);
template solver::WorldDef<3> world_of(const Case&);
template solver::JointDef<2> joint_of(const Command&);
template solver::JointDef<3> joint_of(const Command&);
template Vec<2> vector_of<2>(const Command&, std::size_t);
template Vec<3> vector_of<3>(const Command&, std::size_t);
template solver::Spin<2> spin_of<2>(const Command&, std::size_t);
template solver::Spin<3> spin_of<3>(const Command&, std::size_t);
template solver::Rotation<2> rotation_of<2>(int);
template solver::Rotation<3> rotation_of<3>(int);
template void register_shelf(solver::World<2>&);
template void register_shelf(solver::World<3>&);

}  // namespace cycloid::properties
