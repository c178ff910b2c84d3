#include "scenes/reasons.hpp"

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
  if (field == "points")
    return "has to be a convex outline without repeated points, in the right number";
  if (field == "radius") return "has to be positive and finite";
  if (field == "mass") return "has to be positive, or the shapes have to give it";
  if (field == "rotation" || field == "normal") return "has to have length 1";
  if (field == "upper") return "has to be at least lower, and an angle within 3.2 rad";
  if (field == "axis") return "has to have length 1";
  if (field == "axle") return "has to have length 1, across the axis; the plane has none";
  if (field == "limit_enabled") return "is not possible here: this kind takes no limits";
  if (field == "motor") return "is not possible here: this kind takes no such motor";
  if (field == "kind") return "is not possible here";
  if (field == "half") return "has to be positive and finite along every axis";
  if (field == "triangles")
    return "have to be three different points each, counted from 0, that span an area";
  if (field == "columns") return "have to be 2 or more";
  if (field == "heights") return "have to be finite, in two or more whole rows of columns";
  if (field == "cell") return "has to be positive both ways";
  return "is out of range";
}

std::string reason_of(const solver::Error& error, const SceneBody& body) {
  if (error.index < 0 || std::string_view(error.field) != "points") return reason_of(error);
  switch (body.shapes[static_cast<std::size_t>(error.index)].kind) {
    case solver::ShapeKind::kHull:
      return "has to span a volume, with 4 to 256 points and at most 64 corners";
    case solver::ShapeKind::kMesh:
      return "has to be three finite points or more";
    case solver::ShapeKind::kBox:
    case solver::ShapeKind::kHeightField:
      return "has to be one finite point, or none";
    default:
      return reason_of(error);
  }
}

}  // namespace cycloid::scenes
