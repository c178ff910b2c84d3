#include "scenes/reasons.hpp"

#include "scenes/fields.hpp"

namespace cycloid::scenes {

std::string reason_of(const solver::Error& error) {
  switch (error.code) {
    case solver::Code::kCapacity:
      return "is too small for what the scene has";
    case solver::Code::kUnknownId:
      return "names no body";
    default:
      break;
  }
  const std::string_view field = error.field;
  if (field.starts_with("limits.")) return "has to be at most 16777216";
  if (field == "floating_point_mode")
    return "is not IEEE: this thread rounds other than to nearest, or flushes subnormal numbers; a "
           "library that was linked with -ffast-math does that when it is loaded";
  if (field == "floating_point_flags")
    return "fuse or reorder operations: build with -ffp-contract=off and without -ffast-math";
  if (field == "mass") return "has to be positive, or the shapes have to give it";
  if (field == "rotation" || field == "normal") return "has to have length 1";
  if (field == "upper") return "has to be at least lower, and an angle within 3.2 rad";
  if (field == "axis") return "has to have length 1";
  if (field == "axle") return "has to have length 1, across the axis";
  if (field == "half") return "has to be positive and finite along every axis";
  if (field == "triangles")
    return "have to be three different points each, counted from 0, that span an area";
  if (field == "columns") return "have to be 2 or more";
  if (field == "heights") return "have to be finite, in two or more whole rows of columns";
  if (field == "cell") return "has to be positive both ways";
  return "is out of range";
}

static std::string only_in(const std::string& kind, std::uint32_t dimension,
                           const std::string& instead) {
  const std::string other = std::to_string(5 - dimension);
  return kind + " is of dimension " + std::to_string(dimension) + " only" +
         (instead.empty() ? "" : ": in dimension " + other + " use " + instead);
}

static std::string kind_reason(solver::ShapeKind kind, std::uint32_t dimension) {
  using solver::ShapeKind;
  const std::string name(name_of(kind));
  const bool plane = dimension == 2;
  if (plane && (kind == ShapeKind::kBox || kind == ShapeKind::kHull))
    return only_in(name, 3, "polygon");
  if (plane && (kind == ShapeKind::kMesh || kind == ShapeKind::kHeightField))
    return only_in(name, 3, "chain");
  if (!plane && kind == ShapeKind::kPolygon) return only_in(name, 2, "box or hull");
  if (!plane && kind == ShapeKind::kChain) return only_in(name, 2, "mesh or height_field");
  if (name.empty()) return "is unknown";
  return name + " is of static bodies only: give the body the kind static";
}

static std::string points_reason(solver::ShapeKind kind) {
  switch (kind) {
    case solver::ShapeKind::kHull:
      return "has to span a volume, with 4 to 256 points and at most 64 corners";
    case solver::ShapeKind::kMesh:
      return "has to be three finite points or more";
    case solver::ShapeKind::kBall:
    case solver::ShapeKind::kBox:
    case solver::ShapeKind::kHeightField:
      return "has to be one finite point, or none";
    case solver::ShapeKind::kHalfSpace:
      return "has to be left out: normal and offset say where a half_space is";
    case solver::ShapeKind::kCapsule:
      return "has to be two finite points, apart from each other";
    case solver::ShapeKind::kChain:
      return "has to be two finite points or more, in a loop three, each apart from the next";
    default:
      return "has to be a convex outline of 3 to 8 finite points without repeated ones";
  }
}

static std::string radius_reason(const SceneShape& shape) {
  switch (shape.kind) {
    case solver::ShapeKind::kBall:
    case solver::ShapeKind::kCapsule:
      return "has to be positive and finite";
    case solver::ShapeKind::kPolygon:
    case solver::ShapeKind::kChain:
      return "has to be 0 or more and finite";
    default:
      return "has to be left out: " + std::string(name_of(shape.kind)) + " has none";
  }
}

std::string reason_of(const solver::Error& error, const SceneBody& body, std::uint32_t dimension) {
  const std::string_view field = error.field;
  if (error.index < 0) {
    if (field == "kind") return "is unknown";
    const bool fixed = body.kind == solver::BodyKind::kStatic;
    if (fixed && (field == "velocity" || field == "spin"))
      return "has to be left out: a static body has none";
    return reason_of(error);
  }
  const SceneShape& shape = body.shapes[static_cast<std::size_t>(error.index)];
  if (field == "kind") return kind_reason(shape.kind, dimension);
  if (field == "points") return points_reason(shape.kind);
  if (field == "radius") return radius_reason(shape);
  return reason_of(error);
}

std::string reason_of(const solver::Error& error, const SceneJoint& joint,
                      std::uint32_t dimension) {
  const std::string_view field = error.field;
  const std::string name(name_of(joint.kind));
  if (field == "body_b" && joint.body_a == joint.body_b)
    return "has to be another body than body_a";
  if (field == "body_b") return "does not move, and body_a does not either: one of them has to";
  if (field == "curve") return "needs a chain or polygon on body_a";
  if (field == "limit_enabled") return "has to be left out: " + name + " takes no limits";
  if (field == "motor") return "has to be left out: " + name + " takes no such motor";
  if (field == "axle" && dimension == 2) return "has to be left out: dimension 2 has none";
  if (field == "steering" && dimension == 2) return "has to be left out: dimension 2 has none";
  if (field != "kind") return reason_of(error);
  switch (joint.kind) {
    case solver::JointKind::kGear:
    case solver::JointKind::kCurve:
      return only_in(name, 2, "");
    case solver::JointKind::kHinge:
      return only_in(name, 3, "revolute");
    case solver::JointKind::kConeTwist:
      return only_in(name, 3, "revolute with limits");
    default:
      return "is unknown";
  }
}

}  // namespace cycloid::scenes
