#include "scenes/unused.hpp"

#include "scenes/fields.hpp"

namespace cycloid::scenes {

class UnusedCheck {
 public:
  UnusedCheck(const Scene& scene, std::vector<Mistake>& mistakes)
      : scene_(scene), planar_(scene.dimension == 2), mistakes_(mistakes) {}

  void run() {
    vector("/gravity", scene_.gravity);
    for_each("/bodies", scene_.bodies);
    for_each("/joints", scene_.joints);
    for_each("/cloths", scene_.cloths);
    for_each("/characters", scene_.characters);
    for_each("/prefabs", scene_.prefabs);
    for (std::size_t i = 0; i < scene_.prefabs.size() && !is_full(); ++i) {
      const std::string path = "/prefabs/" + std::to_string(i);
      const char* reason = "has to be left out: the control that spawns a prefab states it";
      refuse(scene_.prefabs[i].position != Triple{}, path + "/position", reason);
      refuse(scene_.prefabs[i].velocity != Triple{}, path + "/velocity", reason);
    }
    for (std::size_t i = 0; i < scene_.seats.size(); ++i)
      for_each("/seats/" + std::to_string(i) + "/controls", scene_.seats[i].controls);
  }

 private:
  template <class Part>
  void for_each(const std::string& path, const std::vector<Part>& parts) {
    for (std::size_t i = 0; i < parts.size() && !is_full(); ++i)
      part(path + "/" + std::to_string(i), parts[i]);
  }

  void part(const std::string& path, const SceneBody& body) {
    vector(path + "/position", body.position);
    vector(path + "/velocity", body.velocity);
    turn(path + "/spin", body.spin);
    const std::array<float, 4> unturned = SceneBody{}.rotation;
    refuse(planar_ && body.rotation != unturned, path + "/rotation",
           "has to be left out in dimension 2: state angle");
    refuse(!planar_ && body.angle != 0.0f, path + "/angle",
           "has to be left out in dimension 3: state rotation");
    for_each(path + "/shapes", body.shapes);
  }

  void part(const std::string& path, const SceneShape& shape) {
    using solver::ShapeKind;
    const SceneShape usual;
    const auto only_of = [&](ShapeKind kind, const char* field, bool stated) {
      refuse(stated && shape.kind != kind, path + "/" + field,
             "has to be left out of all but a " + std::string(name_of(kind)));
    };
    for (std::size_t i = 0; i < shape.points.size() && !is_full(); ++i)
      if (shape.points[i][2] != 0.0f)
        vector(path + "/points/" + std::to_string(i), shape.points[i]);
    vector(path + "/normal", shape.normal);
    only_of(ShapeKind::kHalfSpace, "normal", shape.normal != usual.normal);
    only_of(ShapeKind::kHalfSpace, "offset", shape.offset != usual.offset);
    refuse(shape.kind == ShapeKind::kHalfSpace && shape.radius != usual.radius, path + "/radius",
           "has to be left out: a half_space has none");
    only_of(ShapeKind::kChain, "loop", shape.loop);
    only_of(ShapeKind::kBox, "half", shape.half != usual.half);
    only_of(ShapeKind::kBox, "rotation", shape.rotation != usual.rotation);
    only_of(ShapeKind::kMesh, "triangles", !shape.triangles.empty());
    only_of(ShapeKind::kHeightField, "heights", !shape.heights.empty());
    only_of(ShapeKind::kHeightField, "columns", shape.columns != usual.columns);
    only_of(ShapeKind::kHeightField, "cell", shape.cell != usual.cell);
  }

  void part(const std::string& path, const SceneJoint& joint) {
    vector(path + "/anchor_a", joint.anchor_a);
    vector(path + "/anchor_b", joint.anchor_b);
    vector(path + "/axis", joint.axis);
    vector(path + "/axle", joint.axle);
    vector(path + "/ground_a", joint.ground_a);
    vector(path + "/ground_b", joint.ground_b);
  }

  void part(const std::string& path, const Cloth& cloth) {
    vector(path + "/origin", cloth.origin);
    vector(path + "/across", cloth.across);
    vector(path + "/down", cloth.down);
  }

  void part(const std::string& path, const SceneCharacter& character) {
    vector(path + "/position", character.position);
    vector(path + "/lower", character.lower);
    vector(path + "/upper", character.upper);
    vector(path + "/up", character.up);
  }

  void part(const std::string& path, const Control& control) {
    const Control usual;
    const bool spawns = control.effect == Effect::kSpawn;
    const bool pushes = control.effect == Effect::kForce || control.effect == Effect::kImpulse;
    value(path + "/value", control);
    vector(path + "/position", control.position);
    vector(path + "/velocity", control.velocity);
    const char* of_spawn = "has to be left out of all but spawn";
    refuse(!spawns && control.position != usual.position, path + "/position", of_spawn);
    refuse(!spawns && control.velocity != usual.velocity, path + "/velocity", of_spawn);
    refuse(!spawns && control.limit != usual.limit, path + "/limit", of_spawn);
    refuse(!pushes && control.frame != usual.frame, path + "/frame",
           "has to be left out of all but force and impulse");
  }

  void value(const std::string& path, const Control& control) {
    const char* nothing = "has to be other than 0, or the control does nothing";
    const bool is_zero = control.value == Triple{};
    switch (control.effect) {
      case Effect::kForce:
      case Effect::kImpulse:
      case Effect::kWalk:
        refuse(is_zero, path, nothing);
        return vector(path, control.value);
      case Effect::kTorque:
        refuse(is_zero, path, nothing);
        return turn(path, control.value);
      case Effect::kMotorSpeed:
      case Effect::kSteering:
        return number(path, control.value, "");
      default:
        refuse(!is_zero, path, "has to be left out of spawn and jump");
    }
  }

  /// A place or direction: two numbers in the plane.
  void vector(const std::string& path, const Triple& numbers) {
    refuse(planar_ && numbers[2] != 0.0f, path, "has to be two numbers in dimension 2");
  }
  /// A spin or torque: one number in the plane.
  void turn(const std::string& path, const Triple& numbers) {
    if (planar_) number(path, numbers, " in dimension 2");
  }
  void number(const std::string& path, const Triple& numbers, const std::string& where) {
    refuse(numbers[1] != 0.0f || numbers[2] != 0.0f, path, "has to be one number" + where);
  }

  void refuse(bool is_mistake, const std::string& path, const std::string& reason) {
    if (is_mistake) mistakes_.push_back({path, reason});
  }
  bool is_full() const { return mistakes_.size() >= kMistakesMax; }

  const Scene& scene_;
  bool planar_;
  std::vector<Mistake>& mistakes_;
};

void check_unused(const Scene& scene, std::vector<Mistake>& mistakes) {
  UnusedCheck(scene, mistakes).run();
}

}  // namespace cycloid::scenes
