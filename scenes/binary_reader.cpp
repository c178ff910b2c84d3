#include "scene_generated.h"
#include "scenes/catalogue.hpp"
#include "scenes/zero_signs.hpp"

namespace cycloid::scenes {

static constexpr std::size_t kBinaryBytesMax = 64u << 20;

/// Copies verified tables. A hostile buffer may let many offsets share one string or vector; what
/// is copied out of it is therefore bounded by its own size, which an honest buffer never exceeds.
class BinaryReader {
 public:
  explicit BinaryReader(std::size_t bytes) : budget_(bytes) {}
  bool overdrawn() const { return overdrawn_; }

  std::string text(const flatbuffers::String* from) {
    return from == nullptr || !spend(from->size()) ? std::string() : from->str();
  }
  static Triple triple(const fb::Triple* v) {
    return v == nullptr ? Triple{} : Triple{v->x(), v->y(), v->z()};
  }
  static std::array<float, 4> quadruple(const fb::Quadruple* v) {
    if (v == nullptr) return {};
    return {v->x(), v->y(), v->z(), v->w()};
  }

  template <class Table, class Part>
  void read_all(const flatbuffers::Vector<flatbuffers::Offset<Table>>* from,
                std::vector<Part>& to) {
    if (from == nullptr) return;
    // Its offset, and the one to its vtable, which every table has and may not share.
    constexpr std::size_t kTableBytesMin = sizeof(flatbuffers::uoffset_t) * 2;
    if (!spend(kTableBytesMin * from->size())) return;
    to.reserve(from->size());
    for (const Table* table : *from) {
      read(*table, to.emplace_back());
      if (overdrawn_) return;
    }
  }

  void read(const fb::Material& from, SceneMaterial& to) {
    to.name = text(from.name());
    to.friction = from.friction();
    to.restitution = from.restitution();
    to.rolling_resistance = from.rolling_resistance();
    to.twist_resistance = from.twist_resistance();
  }

  void read(const fb::Shape& from, SceneShape& to) {
    to.kind = static_cast<solver::ShapeKind>(from.kind());
    if (from.points() != nullptr && spend(from.points()->size() * sizeof(fb::Triple))) {
      to.points.reserve(from.points()->size());
      for (const fb::Triple* point : *from.points()) to.points.push_back(triple(point));
    }
    to.radius = from.radius();
    to.normal = triple(from.normal());
    to.offset = from.offset();
    to.loop = from.loop();
    to.half = triple(from.half());
    // Left out by files from before boxes, and of bodies: not turned, as in scene.hpp.
    if (from.rotation() != nullptr) to.rotation = quadruple(from.rotation());
    if (from.triangles() != nullptr && spend(from.triangles()->size() * sizeof(fb::Corners))) {
      to.triangles.reserve(from.triangles()->size());
      for (const fb::Corners* corners : *from.triangles())
        to.triangles.push_back({corners->a(), corners->b(), corners->c()});
    }
    if (from.heights() != nullptr && spend(from.heights()->size() * sizeof(float)))
      to.heights.assign(from.heights()->begin(), from.heights()->end());
    to.columns = from.columns();
    to.cell = {from.cell_x(), from.cell_z()};
    to.density = from.density();
    to.material = text(from.material());
    if (const fb::Filter* filter = from.filter())
      to.filter = {filter->category(), filter->mask(), filter->group()};
  }

  void read(const fb::Body& from, SceneBody& to) {
    to.name = text(from.name());
    to.kind = static_cast<solver::BodyKind>(from.kind());
    to.position = triple(from.position());
    to.angle = from.angle();
    if (from.rotation() != nullptr) to.rotation = quadruple(from.rotation());
    to.velocity = triple(from.velocity());
    to.spin = triple(from.spin());
    to.mass = from.mass();
    to.linear_damping = from.linear_damping();
    to.angular_damping = from.angular_damping();
    to.gravity_scale = from.gravity_scale();
    to.fixed_rotation = from.fixed_rotation();
    to.tag = from.tag();
    read_all(from.shapes(), to.shapes);
  }

  void read(const fb::Joint& from, SceneJoint& to) {
    to.name = text(from.name());
    to.kind = static_cast<solver::JointKind>(from.kind());
    to.body_a = text(from.body_a());
    to.body_b = text(from.body_b());
    to.anchor_a = triple(from.anchor_a());
    to.anchor_b = triple(from.anchor_b());
    to.axis = triple(from.axis());
    to.length = from.length();
    to.ratio = from.ratio();
    to.hertz = from.hertz();
    to.damping_ratio = from.damping_ratio();
    to.angular_hertz = from.angular_hertz();
    to.angular_damping_ratio = from.angular_damping_ratio();
    to.limit_enabled = from.limit_enabled();
    to.lower = from.lower();
    to.upper = from.upper();
    to.motor = static_cast<solver::MotorKind>(from.motor());
    to.motor_speed = from.motor_speed();
    to.motor_max = from.motor_max();
    to.target = from.target();
    to.drive_amplitude = from.drive_amplitude();
    to.drive_hertz = from.drive_hertz();
    to.force_max = from.force_max();
    to.torque_max = from.torque_max();
    to.ground_a = triple(from.ground_a());
    to.ground_b = triple(from.ground_b());
    to.curve = static_cast<solver::CurveKind>(from.curve());
    to.size = {from.size_x(), from.size_y()};
    to.axle = triple(from.axle());
    to.steering = from.steering();
    to.cone = from.cone();
    to.collide_connected = from.collide_connected();
  }

  void read(const fb::ClothPin& from, ClothPin& to) {
    to.column = from.column();
    to.row = from.row();
    to.body = text(from.body());
  }

  void read(const fb::Cloth& from, Cloth& to) {
    to.name = text(from.name());
    to.origin = triple(from.origin());
    to.across = triple(from.across());
    to.down = triple(from.down());
    to.columns = from.columns();
    to.rows = from.rows();
    to.mass = from.mass();
    to.radius = from.radius();
    to.compliance = from.compliance();
    to.shear_compliance = from.shear_compliance();
    to.material = text(from.material());
    if (const fb::Filter* filter = from.filter())
      to.filter = {filter->category(), filter->mask(), filter->group()};
    read_all(from.pins(), to.pins);
  }

  void read(const fb::Character& from, SceneCharacter& to) {
    to.name = text(from.name());
    to.position = triple(from.position());
    to.lower = triple(from.lower());
    to.upper = triple(from.upper());
    to.radius = from.radius();
    to.skin = from.skin();
    to.up = triple(from.up());
    to.slope_cos_min = from.slope_cos_min();
    to.step_height = from.step_height();
    to.push_mass = from.push_mass();
    to.push_force_max = from.push_force_max();
    to.gravity_scale = from.gravity_scale();
    to.speed = from.speed();
    to.acceleration = from.acceleration();
    to.air_acceleration = from.air_acceleration();
    to.jump_speed = from.jump_speed();
    if (const fb::Filter* filter = from.filter())
      to.filter = {filter->category(), filter->mask(), filter->group()};
  }

  void read(const fb::Control& from, Control& to) {
    to.source = static_cast<Source>(from.source());
    to.index = from.index();
    to.effect = static_cast<Effect>(from.effect());
    to.target = text(from.target());
    to.value = triple(from.value());
    to.frame = static_cast<Frame>(from.frame());
    to.position = triple(from.position());
    to.velocity = triple(from.velocity());
    to.limit = from.limit();
  }

  void read(const fb::ScriptEntry& from, ScriptEntry& to) {
    to.from = from.from();
    to.until = from.until();
    to.every = from.every();
    to.hold = from.hold();
    to.axes = quadruple(from.axes());
    to.buttons = from.buttons();
  }

  void read(const fb::Seat& from, Seat& to) {
    to.name = text(from.name());
    read_all(from.controls(), to.controls);
    read_all(from.script(), to.script);
  }

  void read(const fb::Tuning& from, solver::Tuning& to) {
    to.substeps = from.substeps();
    to.sweeps = from.sweeps();
    to.relax_sweeps = from.relax_sweeps();
    to.position_sweeps = from.position_sweeps();
    // The file keeps 0 for what it does not know.
    to.stabilisation =
        static_cast<solver::Stabilisation>(static_cast<std::uint32_t>(from.stabilisation()) - 1);
    to.order = static_cast<solver::Order>(from.order());
    to.contact_block = static_cast<solver::ContactBlockRows>(from.contact_block());
    to.joint_solver = static_cast<solver::JointSolver>(from.joint_solver());
    to.warm_starting = from.warm_starting();
    to.over_relaxation = from.over_relaxation();
    to.baumgarte = from.baumgarte();
    to.slop = from.slop();
    to.correction_max = from.correction_max();
    to.contact_hertz = from.contact_hertz();
    to.contact_damping_ratio = from.contact_damping_ratio();
    to.joint_hertz = from.joint_hertz();
    to.joint_damping_ratio = from.joint_damping_ratio();
    to.push_speed_max = from.push_speed_max();
    to.restitution_threshold = from.restitution_threshold();
    to.speculative_distance = from.speculative_distance();
    to.sleep_s = from.sleep_s();
    to.sleep_speed = from.sleep_speed();
    to.continuous = from.continuous();
    to.particle_substeps = from.particle_substeps();
    to.particle_sweeps = from.particle_sweeps();
    to.particle_damping = from.particle_damping();
  }

  void read(const fb::Limits& from, solver::Limits& to) {
    to = {from.bodies(),    from.shapes(),    from.joints(), from.contacts(), from.materials(),
          from.registers(), from.particles(), from.links(),  from.pins()};
  }

  void read(const fb::Accuracy& from, SceneAccuracy& to) {
    to.error_m = from.error_m();
    to.error_percent = from.error_percent();
    if (from.tuned() == nullptr) return;
    to.tuned.solver_version = from.tuned()->solver_version();
    if (from.tuned()->tuning() != nullptr) read(*from.tuned()->tuning(), to.tuned.tuning);
  }

  void read(const fb::Scene& from, Scene& to) {
    to.name = text(from.name());
    to.summary = text(from.summary());
    to.dimension = from.dimension();
    to.gravity = triple(from.gravity());
    to.tick_hz = from.tick_hz();
    if (from.tuning() != nullptr) read(*from.tuning(), to.tuning);
    if (from.limits() != nullptr) read(*from.limits(), to.limits);
    read_all(from.materials(), to.materials);
    read_all(from.bodies(), to.bodies);
    read_all(from.joints(), to.joints);
    read_all(from.cloths(), to.cloths);
    read_all(from.characters(), to.characters);
    read_all(from.prefabs(), to.prefabs);
    read_all(from.seats(), to.seats);
    if (from.accuracy() != nullptr) read(*from.accuracy(), to.accuracy);
  }

 private:
  bool spend(std::size_t bytes) {
    if (bytes > budget_) overdrawn_ = true;
    if (overdrawn_) return false;
    budget_ -= bytes;
    return true;
  }

  std::size_t budget_;
  bool overdrawn_ = false;
};

Loaded from_binary(std::span<const std::byte> bytes, Untuned untuned) {
  Loaded loaded;
  const auto refuse = [&](const char* reason) {
    loaded.mistakes.push_back({"", reason});
    return loaded;
  };
  // The library compares the identifier without looking at the size, and asserts on the largest.
  if (bytes.empty()) return refuse("is empty");
  if (bytes.size() < 8) return refuse("is neither JSON nor a binary scene");
  if (bytes.size() > kBinaryBytesMax) return refuse("is larger than 64 MiB");
  const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  if (!fb::SceneBufferHasIdentifier(data)) return refuse("is neither JSON nor a binary scene");
  flatbuffers::Verifier verifier(data, bytes.size(), /*max_depth=*/8, /*max_tables=*/1u << 20);
  if (!fb::VerifySceneBuffer(verifier)) return refuse("is a damaged binary scene");
  Scene scene;
  BinaryReader reader(bytes.size());
  reader.read(*fb::GetScene(data), scene);
  drop_zero_signs(scene);
  if (reader.overdrawn()) return refuse("is a damaged binary scene: parts of it overlap");
  loaded.mistakes = check(scene, untuned);
  if (loaded.mistakes.empty()) loaded.scene = std::move(scene);
  return loaded;
}

}  // namespace cycloid::scenes
