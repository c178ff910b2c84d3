#include "bench/tuning/needs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "bench/tuning/examiner.hpp"

namespace cycloid::tuning {

static constexpr std::size_t kNamesMax = 8;

/// "floor, box, 7": as many as fit a line.
static std::string list_text(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kNamesMax); ++i)
    text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kNamesMax)
    text += " and " + std::to_string(names.size() - kNamesMax) + " more";
  return text;
}

static std::string count_text(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

static std::string rate_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

static void drop_sleep(scenes::Scene& scene) {
  scene.tuning.sleep_s = 0.0f;
}
static void drop_continuous(scenes::Scene& scene) {
  scene.tuning.continuous = 0;
}

PartNeed Examiner::rotation() {
  PartNeed need;
  need.part = "rotation";
  std::vector<std::size_t> still;
  std::vector<std::string> names;
  std::size_t turning = 0;
  for (std::size_t i = 0; i < base_.bodies.size(); ++i) {
    if (!base_.bodies[i].turns) continue;
    ++turning;
    if (turned_max_m(base_, i) > request_.bound_m) continue;
    const std::size_t body = base_.bodies[i].index;
    still.push_back(body);
    const std::string& name = scene_.bodies[body].name;
    names.push_back(name.empty() ? std::to_string(body) : name);
  }
  if (turning == 0) {
    need.verdict = PartVerdict::kNotThere;
    need.finding = "no body can turn";
    return need;
  }
  need.finding = std::to_string(still.size()) + " of " + std::to_string(turning) +
                 " bodies turn by no more than " + bound_text();
  if (still.empty()) return need;
  const Drop drop = [still](scenes::Scene& scene) {
    for (const std::size_t body : still) scene.bodies[body].fixed_rotation = true;
  };
  compare(drop, need);
  if (need.verdict == PartVerdict::kNeeded)
    need.finding += ", but held to that the scene goes another way";
  else
    need.change = "\"fixed_rotation\": true in bodies " + list_text(names);
  return need;
}

static void drop_friction(scenes::Scene& scene, const std::vector<std::size_t>& materials) {
  if (scene.materials.empty()) scene.materials.emplace_back();
  for (const std::size_t material : materials) scene.materials[material].friction = 0.0f;
}

/// Which materials some shape, cloth or prefab is made of; one of scenes that state none.
static std::vector<bool> used_materials(const scenes::Scene& scene) {
  std::vector<bool> used(std::max<std::size_t>(1, scene.materials.size()), false);
  const auto use = [&](const std::string& name) {
    std::size_t i = 0;
    while (i < scene.materials.size() && scene.materials[i].name != name) ++i;
    used[i < scene.materials.size() ? i : 0] = true;
  };
  for (const std::vector<scenes::SceneBody>* bodies : {&scene.bodies, &scene.prefabs})
    for (const scenes::SceneBody& body : *bodies)
      for (const scenes::SceneShape& shape : body.shapes) use(shape.material);
  for (const scenes::Cloth& cloth : scene.cloths) use(cloth.material);
  return used;
}

static bool rubs(const scenes::Scene& scene, std::size_t material) {
  return scene.materials.empty() || scene.materials[material].friction > 0.0f;
}

/// Materials whose friction never acts, one after the other on top of those before.
std::vector<std::size_t> Examiner::idle_frictions() const {
  const std::vector<bool> used = used_materials(scene_);
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] && rubs(scene_, i)) all.push_back(i);
  const auto idle = [&](const std::vector<std::size_t>& materials) {
    scenes::Scene without = scene_;
    drop_friction(without, materials);
    return !is_needed(moved_without(without));
  };
  if (all.size() <= 1 || idle(all)) return all;
  std::vector<std::size_t> found;
  for (const std::size_t material : all) {
    found.push_back(material);
    if (!idle(found)) found.pop_back();
  }
  return found;
}

PartNeed Examiner::tangents() {
  PartNeed need;
  need.part = "tangents";
  const std::vector<bool> used = used_materials(scene_);
  bool any = false;
  for (std::size_t i = 0; i < used.size(); ++i) any = any || (used[i] && rubs(scene_, i));
  if (!any) {
    need.verdict = PartVerdict::kNotThere;
    need.finding = "no material that is used has friction";
    return need;
  }
  const std::vector<std::size_t> idle = idle_frictions();
  need.finding = "the friction of every material acts";
  if (idle.empty()) return need;
  compare([idle](scenes::Scene& scene) { drop_friction(scene, idle); }, need);
  if (need.verdict == PartVerdict::kNeeded) return need;
  std::vector<std::string> names;
  for (const std::size_t material : idle)
    names.push_back(scene_.materials.empty() ? "(the one that is meant where none is stated)"
                                             : scene_.materials[material].name);
  need.finding = "friction does not act on " + count_text(idle.size(), "material");
  need.change = "\"friction\": 0 in materials " + list_text(names);
  return need;
}

PartNeed Examiner::sleep() {
  PartNeed need;
  need.part = "sleep";
  if (scene_.tuning.sleep_s == 0.0f) {
    need.verdict = PartVerdict::kNotThere;
    need.finding = "no body is let sleep";
    return need;
  }
  compare(drop_sleep, need);
  const double asleep = base_.asleep_per_tick;
  need.finding = asleep == 0.0 ? "no body ever sleeps"
                               : rate_text(asleep) + " bodies sleep in an average tick";
  // What sleeps costs nothing, so it is kept even where nobody would see it go.
  if (asleep > 0.0 && need.verdict == PartVerdict::kNotNeeded) {
    need.verdict = PartVerdict::kNeeded;
    drops_.pop_back();
  }
  if (need.verdict == PartVerdict::kNotNeeded) need.change = "\"sleep_s\": 0 in tuning";
  return need;
}

PartNeed Examiner::continuous() {
  PartNeed need;
  need.part = "continuous";
  if (scene_.tuning.continuous == 0) {
    need.verdict = PartVerdict::kNotThere;
    need.finding = "no body is stopped in flight";
    return need;
  }
  compare(drop_continuous, need);
  need.finding = "bodies would pass through what they hit, or stop elsewhere";
  if (need.verdict == PartVerdict::kNeeded) return need;
  need.finding = "nothing is so fast that it would pass through something in a tick";
  need.change = "\"continuous\": 0 in tuning";
  return need;
}

/// Whether all ways and turns of the run lie in the plane across an axis.
static bool is_planar(const Passage& passage, std::size_t axis, double bound_m) {
  for (const std::vector<BodyPlace>& look : passage.looks) {
    for (std::size_t body = 0; body < look.size(); ++body) {
      const BodyPlace& start = passage.looks[0][body];
      const BodyPlace& place = look[body];
      if (!place.there) continue;
      if (std::abs(place.position[axis] - start.position[axis]) > bound_m) return false;
      // The rotation since the start, q conj(s): its vector has to lie along the axis.
      const auto& [qx, qy, qz, qw] = place.rotation;
      const auto& [sx, sy, sz, sw] = start.rotation;
      const std::array<double, 3> turn = {sw * qx - qw * sx - (qy * sz - qz * sy),
                                          sw * qy - qw * sy - (qz * sx - qx * sz),
                                          sw * qz - qw * sz - (qx * sy - qy * sx)};
      const double extent = passage.bodies[body].extent_m;
      for (std::size_t k = 0; k < 3; ++k)
        if (k != axis && 2.0 * std::abs(turn[k]) * extent > bound_m) return false;
    }
  }
  return true;
}

PartNeed Examiner::third_axis() const {
  PartNeed need;
  need.part = "3D";
  if (scene_.dimension == 2) {
    need.verdict = PartVerdict::kNotThere;
    need.finding = "the scene is planar";
    return need;
  }
  need.finding = "bodies move or turn along every axis";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!is_planar(base_, axis, request_.bound_m)) continue;
    const std::size_t spared = sizeof(solver::Body<3>) - sizeof(solver::Body<2>);
    need.verdict = PartVerdict::kNoSwitch;
    need.finding = std::string("all motion lies in the plane across ") + "xyz"[axis] +
                   "; a body of the plane has 3 freedoms instead of 6 and " +
                   std::to_string(spared) + " bytes less";
    need.change = "nothing switches it off: the scene has to be written again with dimension 2";
    break;
  }
  return need;
}

PartNeed Examiner::all() {
  PartNeed need;
  need.part = "all";
  const std::vector<Drop> drops = drops_;
  compare(
      [drops](scenes::Scene& scene) {
        for (const Drop& drop : drops) drop(scene);
      },
      need);
  need.finding = need.verdict == PartVerdict::kNotNeeded
                     ? "all of these at once"
                     : "not all of these at once: together they move bodies further";
  return need;
}

const char* name_of(PartVerdict verdict) {
  switch (verdict) {
    case PartVerdict::kNeeded:
      return "needed";
    case PartVerdict::kNotNeeded:
      return "not needed";
    case PartVerdict::kNotThere:
      return "not there";
    case PartVerdict::kNoSwitch:
      return "no switch";
  }
  return "unknown";
}

std::vector<PartNeed> find_needs(const scenes::Scene& scene, const accuracy::Setting& setting,
                                 const NeedsRequest& request) {
  Examiner examiner(scene, setting, request);
  std::vector<PartNeed> needs = {examiner.rotation(), examiner.tangents(), examiner.sleep(),
                                 examiner.continuous(), examiner.third_axis()};
  std::size_t droppable = 0;
  for (const PartNeed& need : needs)
    if (need.verdict == PartVerdict::kNotNeeded) ++droppable;
  if (droppable > 1) needs.push_back(examiner.all());
  return needs;
}

}  // namespace cycloid::tuning
