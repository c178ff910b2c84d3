#include "scenes/build.hpp"

#include <map>
#include <optional>

#include "scenes/accuracy.hpp"
#include "scenes/characters.hpp"
#include "scenes/definitions.hpp"
#include "scenes/names.hpp"
#include "scenes/needs.hpp"
#include "scenes/reasons.hpp"
#include "scenes/weave.hpp"

namespace cycloid::scenes {

using solver::Error;

static std::string at(const std::string& path, std::size_t i) {
  return path + "/" + std::to_string(i);
}

struct NamedJoint {
  solver::JointId id;
  std::size_t index = 0;  ///< In the scene.
};

template <int D>
class Builder {
 public:
  Builder(const Scene& scene, std::vector<Mistake>& mistakes)
      : scene_(scene), mistakes_(mistakes) {}

  std::unique_ptr<Built<D>> build() {
    const std::size_t before = mistakes_.size();
    limits_ = checked_limits(scene_, mistakes_);
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) name_material(i);
    solver::Result<solver::World<D>> world = solver::World<D>::create(world_def());
    if (!world.ok()) {
      complain(world_path(world.error()), world.error());
      return nullptr;
    }
    built_ = std::make_unique<Built<D>>(Built<D>{std::move(world.value()), {}, {}, {}, 0});
    const auto go_on = [&](std::size_t i, const auto& parts) {
      return i < parts.size() && mistakes_.size() < kMistakesMax;
    };
    for (std::size_t i = 0; go_on(i, scene_.bodies); ++i) add_body(i);
    for (std::size_t i = 0; go_on(i, scene_.joints); ++i) add_joint(i);
    for (std::size_t i = 0; go_on(i, scene_.cloths); ++i) add_cloth(i);
    for (std::size_t i = 0; go_on(i, scene_.prefabs); ++i) add_prefab(i);
    for (std::size_t i = 0; go_on(i, scene_.characters); ++i) add_character(i);
    for (std::size_t i = 0; go_on(i, scene_.seats); ++i) add_seat(i);
    add_registers();
    return mistakes_.size() == before ? std::move(built_) : nullptr;
  }

 private:
  void complain(const std::string& path, const Error& error) {
    mistakes_.push_back({path, reason_of(error)});
  }
  void complain(const std::string& path, const std::string& reason) {
    mistakes_.push_back({path, reason});
  }

  solver::WorldDef<D> world_def() const {
    solver::WorldDef<D> def;
    def.gravity = vec<D>(scene_.gravity);
    def.tick_s = 1.0f / scene_.tick_hz;
    def.tuning = tuning_of(scene_);
    def.limits = limits_;
    def.materials.clear();
    for (const SceneMaterial& material : scene_.materials)
      def.materials.push_back({material.friction, material.restitution, material.rolling_resistance,
                               material.twist_resistance});
    if (def.materials.empty()) def.materials.push_back({});
    return def;
  }

  std::string world_path(const Error& error) const {
    const std::string field = error.field;
    if (error.index >= 0) return "/materials/" + std::to_string(error.index) + "/" + field;
    if (field == "gravity" || field == "materials") return "/" + field;
    if (field == "tick_s") return "/tick_hz";
    if (field.starts_with("limits.")) return "/limits/" + field.substr(7);
    if (field.starts_with("floating_point_")) return field;  // Of the process, not of the scene.
    return tuning_path(scene_, field);
  }

  void name_material(std::size_t i) {
    const std::string& name = scene_.materials[i].name;
    if (name.empty()) return;  // Shapes that name none are of the first.
    if (!materials_.emplace(name, static_cast<std::uint32_t>(i)).second)
      complain(at("/materials", i) + "/name", "is the name of an earlier material: '" + name + "'");
  }

  std::uint32_t material_index(const std::string& name) const {
    const auto found = materials_.find(name);
    if (found != materials_.end()) return found->second;
    return name.empty() ? 0 : solver::kNone;
  }

  /// False, with a mistake, where a shape names a material that is not there.
  bool make_body(const SceneBody& from, const std::string& path, Prefab<D>& to) {
    to.body = body_def<D>(from);
    for (std::size_t i = 0; i < from.shapes.size(); ++i) {
      const SceneShape& shape = from.shapes[i];
      solver::ShapeDef<D>& def = to.shapes.emplace_back(shape_def<D>(shape));
      def.material = material_index(shape.material);
      if (def.material != solver::kNone) continue;
      complain(at(path + "/shapes", i) + "/material",
               "names no material: '" + shape.material + "'");
      return false;
    }
    return true;
  }

  /// The angle is the planar name of what the solver calls rotation.
  static std::string body_path(const std::string& path, const Error& error) {
    const std::string field = error.field;
    if (field.starts_with("limits.")) return "/limits/" + field.substr(7);
    const bool of_shape = error.index >= 0;
    return (of_shape ? at(path + "/shapes", static_cast<std::size_t>(error.index)) : path) + "/" +
           field;
  }

  void add_body(std::size_t i) {
    const SceneBody& from = scene_.bodies[i];
    const std::string path = at("/bodies", i);
    Prefab<D> def;
    std::optional<solver::BodyId> made;
    if (make_body(from, path, def)) {
      const solver::Result<solver::BodyId> id = built_->world.create_body(def.body, def.shapes);
      if (id.ok())
        made = id.value();
      else
        complain(body_path(path, id.error()), reason_of(id.error(), from, D));
    }
    bodies_.add(from.name, path, made);
  }

  bool find_body(const std::string& name, const std::string& path, solver::BodyId& id) {
    const solver::BodyId* found = bodies_.find(name, path);
    if (found != nullptr) id = *found;
    return found != nullptr;
  }

  void add_joint(std::size_t i) {
    const SceneJoint& from = scene_.joints[i];
    const std::string path = at("/joints", i);
    solver::JointDef<D> def = joint_def<D>(from);
    const bool a = find_body(from.body_a, path + "/body_a", def.body_a);
    const bool b = find_body(from.body_b, path + "/body_b", def.body_b);
    std::optional<NamedJoint> made;
    if (a && b) {
      const solver::Result<solver::JointId> id = built_->world.create_joint(def);
      if (id.ok())
        made = NamedJoint{id.value(), i};
      else
        complain(path + "/" + id.error().field, reason_of(id.error(), from, D));
    }
    joints_.add(from.name, path, made);
  }

  /// Limits are no reason: they have been raised to what the scene needs.
  static std::string cloth_reason(const std::string& field) {
    if (field != "columns" && field != "rows") return "is out of range";
    return "has to be 1 or more, and all cloths have at most " +
           std::to_string(kClothParticlesMax) + " particles together";
  }

  void add_cloth(std::size_t i) {
    const Cloth& cloth = scene_.cloths[i];
    const std::string path = at("/cloths", i);
    const std::uint32_t material = material_index(cloth.material);
    if (material == solver::kNone)
      return complain(path + "/material", "names no material: '" + cloth.material + "'");
    Weave weave;
    if (const std::string field = weave_cloth(cloth, material, built_->world, weave);
        !field.empty())
      return complain(path + "/" + field, cloth_reason(field));
    for (std::size_t p = 0; p < cloth.pins.size(); ++p)
      add_cloth_pin(cloth, cloth.pins[p], at(path + "/pins", p), weave);
  }

  void add_cloth_pin(const Cloth& cloth, const ClothPin& pin, const std::string& path,
                     const Weave& weave) {
    if (pin.column >= cloth.columns) return complain(path + "/column", "is not in the cloth");
    if (pin.row >= cloth.rows) return complain(path + "/row", "is not in the cloth");
    solver::PinDef<D> def;
    def.particle = weave[pin.row * cloth.columns + pin.column];
    const solver::Vec<D> place = built_->world.state().particles[def.particle.index].position;
    if (pin.body.empty()) {
      // The world's own place: a static body without shapes, made when the first cloth asks for it.
      if (anchor_body_.index == solver::kNone) {
        solver::BodyDef<D> fixed;
        fixed.kind = solver::BodyKind::kStatic;
        const auto id = built_->world.create_body(fixed, {});
        if (!id.ok()) return complain("/limits/bodies", id.error());
        anchor_body_ = id.value();
      }
      def.body = anchor_body_;
    } else if (!find_body(pin.body, path + "/body", def.body)) {
      return;
    }
    const solver::BodyView<D> view = built_->world.body(def.body).value();
    def.anchor = solver::rotate_back(view.rotation, place - view.position);
    const auto id = built_->world.create_pin(def);
    if (!id.ok()) complain(path, id.error());
  }

  /// A prefab is tried out in a world of its own, so that spawning it can fail for room alone.
  void add_prefab(std::size_t i) {
    const SceneBody& from = scene_.prefabs[i];
    const std::string path = at("/prefabs", i);
    Prefab<D> prefab;
    std::optional<std::size_t> made;
    if (make_body(from, path, prefab) && is_possible(prefab, from, path)) {
      made = built_->prefabs.size();
      built_->prefabs.push_back(std::move(prefab));
    }
    if (from.name.empty()) complain(path + "/name", "has to be given: controls spawn by it");
    prefabs_.add(from.name, path, made);
  }

  bool is_possible(const Prefab<D>& prefab, const SceneBody& from, const std::string& path) {
    solver::WorldDef<D> def = world_def();
    // Room for one prefab; but all materials of the scene have to fit.
    def.limits = {};
    def.limits.materials = limits_.materials;
    def.limits.shapes = limits_.shapes;
    solver::Result<solver::World<D>> world = solver::World<D>::create(def);
    if (!world.ok()) return false;  // Said already, of the scene's own world.
    const solver::Result<solver::BodyId> id = world.value().create_body(prefab.body, prefab.shapes);
    if (!id.ok()) complain(body_path(path, id.error()), reason_of(id.error(), from, D));
    return id.ok();
  }

  void add_character(std::size_t i) {
    const SceneCharacter& from = scene_.characters[i];
    const std::string path = at("/characters", i);
    built_->characters.push_back(make_character<D>(from, path, mistakes_));
    characters_.add(from.name, path, i);
  }

  /// Those of the seats are counted by now; the characters' come after them.
  void add_registers() {
    for (Character<D>& character : built_->characters) {
      character.first_register = registers_;
      registers_ += kCharacterRegisters<D>;
    }
    built_->register_count = registers_;
    // A control is a few bytes and asks for hundreds of registers.
    constexpr std::uint32_t kRegistersMax = 1u << 20;
    if (registers_ > kRegistersMax)
      return complain("/seats", "ask for more than 1048576 registers");
    if (!built_->world.resize_registers(registers_).ok())
      return complain("/limits/registers", too_small(limits_.registers, registers_));
    start_characters(*built_);
  }

  void add_seat(std::size_t i) {
    const std::string path = at("/seats", i);
    BoundSeat& seat = built_->seats.emplace_back();
    if (i == 0) registers_ = static_cast<std::uint32_t>(scene_.seats.size());
    for (std::size_t c = 0; c < scene_.seats[i].controls.size(); ++c)
      add_control(scene_.seats[i].controls[c], at(path + "/controls", c), seat);
  }

  /// The world passes over what acts on a body without an inverse mass, or would turn a particle.
  bool bind_body(const Control& control, const std::string& path, BoundControl& bound) {
    if (!find_body(control.target, path + "/target", bound.body)) return false;
    const solver::Body<D>& body = built_->world.state().bodies[bound.body.index];
    const bool never_turns = body.kind == solver::BodyKind::kParticle;
    std::string reason;
    if (body.inverse_mass == 0.0f) reason = "names a body that nothing moves: it has to be dynamic";
    if (control.effect == Effect::kTorque && never_turns) reason = "names a particle: none turns";
    if (!reason.empty()) complain(path + "/target", reason);
    return reason.empty();
  }

  bool bind_joint(const Control& control, const std::string& path, BoundControl& bound) {
    const NamedJoint* found = joints_.find(control.target, path + "/target");
    if (found == nullptr) return false;
    const SceneJoint& joint = scene_.joints[found->index];
    bound.joint = found->id;
    bound.motor_max = joint.motor_max;
    const bool steers = joint.kind == solver::JointKind::kWheel && solver::Dim<D>::kSpin > 1;
    std::string reason;
    if (control.effect == Effect::kMotorSpeed && joint.motor != solver::MotorKind::kSpeed)
      reason = "names a joint without a motor of speed";
    if (control.effect == Effect::kSteering && !steers) reason = "names no wheel in space";
    if (!reason.empty()) complain(path + "/target", reason);
    return reason.empty();
  }

  void add_control(const Control& control, const std::string& path, BoundSeat& seat) {
    BoundControl bound;
    bound.control = control;
    switch (control.effect) {
      case Effect::kForce:
      case Effect::kTorque:
      case Effect::kImpulse:
        if (!bind_body(control, path, bound)) return;
        break;
      case Effect::kMotorSpeed:
      case Effect::kSteering:
        if (!bind_joint(control, path, bound)) return;
        break;
      case Effect::kSpawn: {
        const std::size_t* found = prefabs_.find(control.target, path + "/target");
        if (found == nullptr) return;
        bound.prefab = *found;
        bound.first_register = registers_;
        registers_ += 1 + 2 * control.limit;
        break;
      }
      case Effect::kWalk:
      case Effect::kJump: {
        const std::size_t* found = characters_.find(control.target, path + "/target");
        if (found == nullptr) return;
        bound.character = *found;
        break;
      }
      default:
        return complain(path + "/effect", "is unknown");
    }
    seat.controls.push_back(std::move(bound));
  }

  const Scene& scene_;
  std::vector<Mistake>& mistakes_;
  std::unique_ptr<Built<D>> built_;
  solver::Limits limits_;
  std::map<std::string, std::uint32_t> materials_;
  NameTable<solver::BodyId> bodies_{"body", mistakes_};
  NameTable<NamedJoint> joints_{"joint", mistakes_};
  solver::BodyId anchor_body_;
  NameTable<std::size_t> prefabs_{"prefab", mistakes_};
  NameTable<std::size_t> characters_{"character", mistakes_};
  std::uint32_t registers_ = 0;
};

template <int D>
std::unique_ptr<Built<D>> build(const Scene& scene, std::vector<Mistake>& mistakes) {
  return Builder<D>(scene, mistakes).build();
}

template std::unique_ptr<Built<2>> build(const Scene&, std::vector<Mistake>&);
template std::unique_ptr<Built<3>> build(const Scene&, std::vector<Mistake>&);

}  // namespace cycloid::scenes
