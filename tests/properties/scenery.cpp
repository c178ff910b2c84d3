#include "tests/properties/scenery.hpp"

#include "solver/trig.hpp"

namespace cycloid::properties {

using solver::BodyKind;
using solver::JointKind;
using solver::ShapeDef;
using solver::ShapeKind;
using solver::Vec;

/// -1 to 1, other ones from one `index` to the next.
static float scattered(std::uint32_t index) {
  return 0.125f * (static_cast<float>((index * 37 + 11) % 17) - 8.0f);
}

/// Of unit length. By no libm, so that a seed names the same cases on every platform.
static Vec<2> direction_of(float angle) {
  Vec<2> direction;
  solver::sin_cos(angle, direction[1], direction[0]);
  return direction;
}

/// Where the bodies of a crowd stand.
struct Places {
  std::uint32_t columns = 0;
  std::uint32_t layers = 1;  ///< Along the third axis.
  float across = 1.0f;       ///< From one to the next, in their widths.
  float up = 1.0f;
  float stagger = 0.0f;  ///< Of every other row, in their widths.
  float scatter = 0.0f;
};

template <int D>
static Places places_of(std::uint32_t choice) {
  constexpr bool kSpace = D == 3;
  switch (choice % 5) {
    case 0:
      return {10, 1, 1.0f, 1.0f, 0.5f, 0.0f};
    case 1:
      return {kSpace ? 5u : 10u, kSpace ? 5u : 1u, 1.0f, 1.0f, 0.0f, 0.0f};
    case 2:
      return {kSpace ? 4u : 7u, kSpace ? 4u : 1u, 1.05f, 1.1f, 0.0f, 0.1f};
    case 3:
      return {kSpace ? 10u : 101u, kSpace ? 11u : 1u, 1.0f, 1.0f, 0.0f, 0.0f};
    default:
      return {kSpace ? 4u : 12u, kSpace ? 4u : 1u, 3.0f, 1.0f, 0.0f, 0.0f};
  }
}

template <int D>
std::vector<Piece<D>> crowd_of(const Command& command) {
  constexpr float kSize = 0.25f;
  const std::uint32_t count = 66 + command.a % 36;
  const Places places = places_of<D>(command.b);
  Vec<D> half = Vec<D>::zero();
  for (int axis = 0; axis < D; ++axis) half[axis] = 30.0f;
  half[1] = 0.5f;
  Piece<D> floor;
  floor.body.kind = BodyKind::kStatic;
  floor.body.position = vector_of<D>(command, 0);
  floor.shapes = {box_of(half)};
  std::vector<Piece<D>> pieces = {floor};
  for (int axis = 0; axis < D; ++axis) half[axis] = kSize;
  const float up = places.up + (command.v[4] < 0 ? 0.2f : 0.0f);
  const std::uint32_t balls = command.v[3] < 60 ? 1000 : 3;  // Every how many.
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t row = i / (places.columns * places.layers);
    const std::uint32_t place = i % (places.columns * places.layers);
    const float first = 0.5f * static_cast<float>(places.columns);
    Piece<D> piece;
    Vec<D>& position = piece.body.position;
    position = floor.body.position;
    position[0] += 2.0f * kSize *
                   (places.across * (static_cast<float>(place % places.columns) - first) +
                    places.stagger * static_cast<float>(row % 2));
    position[1] += 0.5f + kSize + 2.0f * kSize * up * static_cast<float>(row);
    if (D == 3)
      position[D - 1] += 2.0f * kSize * places.across * static_cast<float>(place / places.columns);
    position[0] += kSize * places.scatter * scattered(i);
    position[D - 1] += kSize * places.scatter * scattered(i + 5);
    ShapeDef<D> ball;
    ball.radius = kSize;
    piece.shapes = {i % balls == balls - 1 ? ball : box_of(half)};
    piece.shapes[0].material = static_cast<std::uint32_t>(command.v[7] + 300) % 9 / 4;
    pieces.push_back(piece);
  }
  return pieces;
}

/// A ring that is solid outside or inside, by the direction in which it goes.
static ShapeDef<2> ring(ShapeDef<2> shape, bool inside) {
  shape.kind = ShapeKind::kChain;
  shape.loop = true;
  for (int i = 0; i < 9; ++i) {
    const float radius = 5.0f + 0.3f * static_cast<float>(i * i % 4);
    shape.points.push_back(radius * direction_of(0.698f * static_cast<float>(inside ? -i : i)));
  }
  return shape;
}
/// A bowl of triangles, or its other side.
static ShapeDef<3> ring(ShapeDef<3> shape, bool inside) {
  constexpr std::uint32_t kSide = 6;
  shape.kind = ShapeKind::kMesh;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const float x = 2.3f * (static_cast<float>(i % kSide) - 2.5f);
    const float z = 2.1f * (static_cast<float>(i / kSide) - 2.5f);
    shape.points.push_back({{x, 0.08f * (x * x + z * z) + 0.1f * scattered(i), z}});
  }
  for (std::uint32_t i = 0; i + kSide + 1 < kSide * kSide; ++i) {
    if (i % kSide == kSide - 1) continue;
    shape.triangles.push_back({i, i + kSide, i + 1});
    shape.triangles.push_back({i + 1, i + kSide, i + kSide + 1});
  }
  for (std::array<std::uint32_t, 3>& triangle : shape.triangles)
    if (!inside) std::swap(triangle[1], triangle[2]);
  return shape;
}

template <int D>
Piece<D> land_of(const Command& command) {
  Piece<D> piece;
  piece.body.kind = BodyKind::kStatic;
  piece.body.position = vector_of<D>(command, 0);
  if (command.a % 2 == 1) piece.body.rotation = rotation_of<D>(command.v[3]);
  ShapeDef<D> slope;
  slope.kind = ShapeKind::kHalfSpace;
  slope.normal[0] = 0.6f;
  slope.normal[1] = 0.8f;
  slope.offset = -1.3f;
  switch (command.b % 5) {
    case 0:
      piece.shapes = {ring(ShapeDef<D>{}, true)};
      break;
    case 1:
      piece.shapes = {ring(ShapeDef<D>{}, false)};
      break;
    case 2:
      piece.shapes = {land(ShapeDef<D>{})};
      break;
    case 3:
      piece.shapes = {slope};
      break;
    default:
      piece.shapes = {land(ShapeDef<D>{}), ring(ShapeDef<D>{}, true), slope};
  }
  for (ShapeDef<D>& shape : piece.shapes)
    shape.material = static_cast<std::uint32_t>(command.v[7] + 300) % 3;
  return piece;
}

/// Eight corners, rounded.
static ShapeDef<2> cornered(ShapeDef<2> shape, float size, std::uint32_t) {
  shape.kind = ShapeKind::kPolygon;
  for (int i = 0; i < 8; ++i) {
    const Vec<2> direction = direction_of(0.785f * static_cast<float>(i));
    shape.points.push_back({{size * direction[0], 0.8f * size * direction[1]}});
  }
  shape.radius = 0.02f;
  return shape;
}
/// 4 to 60 points of an egg.
static ShapeDef<3> cornered(ShapeDef<3> shape, float size, std::uint32_t choice) {
  shape.kind = ShapeKind::kHull;
  const std::uint32_t count = 4 + choice % 57;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float share = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
    const Vec<2> direction = direction_of(2.4f * static_cast<float>(i));
    const float height = 1.0f - 2.0f * share;
    const float radius = size * solver::sqrt(1.0f - height * height);
    shape.points.push_back({{radius * direction[0], 1.2f * size * height, radius * direction[1]}});
  }
  return shape;
}

static void turn_box(ShapeDef<2>&, int) {}
static void turn_box(ShapeDef<3>& shape, int value) {
  shape.rotation = rotation_of<3>(value);
  shape.points = {{{0.3f, -0.1f, 0.2f}}};
}

template <int D>
Piece<D> solid_of(const Command& command) {
  Piece<D> piece;
  const float size = size_of(command.v[6] / 2);
  piece.body.position = vector_of<D>(command, 0);
  piece.body.rotation = rotation_of<D>(command.v[3]);
  piece.body.velocity = vector_of<D>(command, 4);
  piece.body.tag = command.b;
  if (command.a % 4 == 1) piece.body.mass = 3.0f * size;
  if (command.a % 8 == 2) piece.body.angular_damping = 0.7f;
  if (command.a % 8 == 3) piece.body.gravity_scale = -0.4f;
  if (command.a % 8 == 6) piece.body.kind = BodyKind::kKinematic;
  const ShapeDef<D> solid = cornered(ShapeDef<D>{}, size, command.a);
  Vec<D> half = Vec<D>::zero();
  for (int axis = 0; axis < D; ++axis) half[axis] = size * (1.0f - 0.2f * static_cast<float>(axis));
  ShapeDef<D> box = box_of(half);
  turn_box(box, command.v[7]);
  ShapeDef<D> rod;
  rod.kind = ShapeKind::kCapsule;
  rod.radius = 0.1f;
  rod.points = {-half, 2.0f * half};
  rod.density = command.b % 3 == 0 ? 0.0f : 20.0f;
  piece.shapes = {solid};
  if (command.b % 3 == 1) piece.shapes = {box};
  if (command.b % 3 == 2) piece.shapes = {solid, rod, box};
  for (std::size_t i = 0; i < piece.shapes.size(); ++i) {
    piece.shapes[i].material = static_cast<std::uint32_t>(i + command.b) % 3;
    piece.shapes[i].filter.group = command.b % 16 == 9 ? 1 : 0;
    if (command.b % 16 == 5) piece.shapes[i].filter.category = 1u << i;
  }
  return piece;
}

template <int D>
Cloth<D> cloth_of(const Command& command) {
  const bool rope = command.b % 2 == 0;
  const std::uint32_t columns = 2 + command.a % (rope ? 12 : 4);
  const std::uint32_t rows = rope ? 1 : 2 + command.b / 2 % 3;
  Cloth<D> cloth;
  cloth.length = 0.5f * size_of(command.v[3]);
  cloth.compliance = command.b % 8 < 4 ? 0.0f : 0.002f;
  for (std::uint32_t i = 0; i < columns * rows; ++i) {
    solver::ParticleDef<D> particle;
    particle.position = vector_of<D>(command, 0);
    particle.position[0] += cloth.length * static_cast<float>(i % columns);
    particle.position[D - 1] += cloth.length * static_cast<float>(i / columns);
    particle.velocity = 0.3f * vector_of<D>(command, 4);
    particle.mass = i == 0 && command.a % 4 == 1 ? 0.0f : 0.02f;
    particle.radius = 0.03f;
    particle.material = static_cast<std::uint32_t>(command.v[7] + 300) % 3;
    particle.group = command.a;
    if (command.b % 16 == 7) particle.filter.mask = 2;
    cloth.particles.push_back(particle);
    if (i % columns > 0) cloth.links.emplace_back(i - 1, i);
    if (i >= columns) cloth.links.emplace_back(i - columns, i);
  }
  return cloth;
}

/// What the other dimension has not, for what this one has not.
template <int D>
static JointKind kind_in(JointKind kind) {
  if (D == 3 && kind == JointKind::kGear) return JointKind::kHinge;
  if (D == 3 && kind == JointKind::kCurve) return JointKind::kConeTwist;
  if (D == 2 && kind == JointKind::kHinge) return JointKind::kGear;
  if (D == 2 && kind == JointKind::kConeTwist) return JointKind::kCurve;
  return kind;
}

template <int D>
solver::JointDef<D> drive_of(const Command& command) {
  solver::JointDef<D> def = joint_of<D>(command);
  def.kind = kind_in<D>(def.kind);
  const bool turns = def.kind == (D == 2 ? JointKind::kRevolute : JointKind::kHinge);
  const bool slides = def.kind == JointKind::kDistance || def.kind == JointKind::kPrismatic ||
                      def.kind == JointKind::kUser || def.kind == JointKind::kWheel;
  const bool bends = def.kind == JointKind::kPulley || def.kind == JointKind::kCurve ||
                     def.kind == JointKind::kConeTwist;
  def.limit_enabled = (turns || slides || bends) && command.v[5] % 2 == 0;
  if (!turns && !slides) def.motor = solver::MotorKind::kOff;
  if (def.kind == JointKind::kWheel && def.motor == solver::MotorKind::kPosition)
    def.motor = solver::MotorKind::kSpeed;
  if (D == 3 && def.kind == JointKind::kWheel) def.axle[D - 1] = 1.0f;
  const auto bits = static_cast<std::uint32_t>(command.v[6] + 128);
  def.anchor_a = 0.2f * vector_of<D>(command, 1);
  def.anchor_b = 0.2f * vector_of<D>(command, 3);
  def.axis[0] = 0.8f;
  def.axis[1] = (bits & 1) != 0 ? 0.6f : -0.6f;
  if (def.kind == JointKind::kGear && (bits & 2) != 0) def.axis = Vec<D>::zero();
  if (D == 3) def.steering = def.kind == JointKind::kWheel && (bits & 2) != 0 ? 0.4f : 0.0f;
  def.angular_hertz = (bits & 4) != 0 ? 2.5f : 0.0f;
  def.angular_damping_ratio = 0.6f;
  def.cone = (bits & 8) != 0 ? 1.1f : 0.0f;
  def.curve = static_cast<solver::CurveKind>(bits / 16 % 4);
  def.ratio = (bits & 2) != 0 ? -0.7f : 1.0f;
  def.target = 0.1f * number_of(command, 7);
  if (def.kind == JointKind::kPulley && (bits & 4) != 0) def.length = 0.0f;
  if ((bits & 32) != 0) def.lower = def.upper;
  if ((bits & 64) != 0) def.force_max = 1.0e6f;
  return def;
}

solver::Material surface_of(const Command& command) {
  const auto share = [&](std::size_t i) {
    return 0.01f * static_cast<float>(command.v[i] < 0 ? -command.v[i] : command.v[i]);
  };
  return {command.b % 4 == 0 ? 0.0f : 1.5f * share(0), command.b % 3 == 0 ? 0.0f : share(1),
          command.b % 5 < 2 ? 0.0f : 0.3f * share(2), command.b % 7 < 3 ? 0.0f : 0.2f * share(3)};
}

template std::vector<Piece<2>> crowd_of(const Command&);
template std::vector<Piece<3>> crowd_of(const Command&);
template Piece<2> land_of(const Command&);
template Piece<3> land_of(const Command&);
template Piece<2> solid_of(const Command&);
template Piece<3> solid_of(const Command&);
template Cloth<2> cloth_of(const Command&);
template Cloth<3> cloth_of(const Command&);
template solver::JointDef<2> drive_of(const Command&);
template solver::JointDef<3> drive_of(const Command&);

}  // namespace cycloid::properties
