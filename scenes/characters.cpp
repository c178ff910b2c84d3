#include "scenes/characters.hpp"

#include <algorithm>
#include <bit>

#include "scenes/definitions.hpp"
#include "solver/validate.hpp"

namespace cycloid::scenes {

using solver::MoverState;
using solver::Vec;

/// Every range of a character's fields; `dimension` numbers of `up` have length 1.
class CharacterCheck {
 public:
  CharacterCheck(const SceneCharacter& character, const std::string& path,
                 std::vector<Mistake>& mistakes)
      : character_(character), path_(path), mistakes_(mistakes) {}

  void run(int dimension) {
    const SceneCharacter& c = character_;
    triple("position", c.position, solver::kPositionMax);
    triple("lower", c.lower, solver::kSizeMax);
    triple("upper", c.upper, solver::kSizeMax);
    triple("up", c.up, 2.0f);
    const float length = squared(c.up, {}, dimension);
    if (!solver::within(length, 0.998f, 1.002f)) complain("up", "has to have length 1");
    const float height = squared(c.upper, c.lower, dimension);
    if (height > 0.0f && height < solver::kSizeMin * solver::kSizeMin)
      complain("upper", "has to be equal to lower, or farther away");
    number("radius", c.radius, solver::kSizeMin, solver::kSizeMax);
    number("skin", c.skin, solver::kSizeMin, solver::kSizeMax);
    if (c.skin > 0.5f * c.radius) complain("skin", "has to be at most half of the radius");
    number("slope_cos_min", c.slope_cos_min, 0.02f, 1.0f);
    number("step_height", c.step_height, 0.0f, solver::kSizeMax);
    number("push_mass", c.push_mass, solver::kMassMin, solver::kMassMax);
    number("push_force_max", c.push_force_max, 0.0f, solver::kForceMax);
    number("gravity_scale", c.gravity_scale, -1.0e3f, 1.0e3f);
    number("speed", c.speed, 0.0f, solver::kSpeedMax);
    number("acceleration", c.acceleration, 0.0f, 1.0e9f);
    number("air_acceleration", c.air_acceleration, 0.0f, 1.0e9f);
    number("jump_speed", c.jump_speed, 0.0f, solver::kSpeedMax);
  }

 private:
  static float squared(const Triple& a, const Triple& b, int dimension) {
    float sum = 0.0f;
    for (std::size_t i = 0; i < static_cast<std::size_t>(dimension); ++i)
      sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
  }
  void complain(const char* field, const char* reason) {
    mistakes_.push_back({path_ + "/" + field, reason});
  }
  void number(const char* field, float value, float lower, float upper) {
    if (solver::within(value, lower, upper)) return;
    const bool positive = lower > 0.0f && value <= 0.0f;
    complain(field, positive ? "has to be positive" : "is out of range");
  }
  void triple(const char* field, const Triple& value, float bound) {
    if (!solver::within(vec<3>(value), bound)) complain(field, "is out of range");
  }

  const SceneCharacter& character_;
  const std::string& path_;
  std::vector<Mistake>& mistakes_;
};

template <int D>
Character<D> make_character(const SceneCharacter& from, const std::string& path,
                            std::vector<Mistake>& mistakes) {
  CharacterCheck(from, path, mistakes).run(D);
  Character<D> to;
  to.mover.lower = vec<D>(from.lower);
  to.mover.upper = vec<D>(from.upper);
  to.mover.radius = from.radius;
  to.mover.skin = from.skin;
  to.mover.up = vec<D>(from.up);
  to.mover.slope_cos_min = from.slope_cos_min;
  to.mover.step_height = from.step_height;
  to.mover.push_mass = from.push_mass;
  to.mover.push_force_max = from.push_force_max;
  to.mover.filter.filter = from.filter;
  to.start = vec<D>(from.position);
  to.gravity_scale = from.gravity_scale;
  to.speed = from.speed;
  to.acceleration = from.acceleration;
  to.air_acceleration = from.air_acceleration;
  to.jump_speed = from.jump_speed;
  return to;
}

template <int D>
static Vec<D> read_vec(std::span<const std::uint32_t> words) {
  Vec<D> value;
  for (int i = 0; i < D; ++i)
    value[i] = std::bit_cast<float>(words[static_cast<std::size_t>(i)]) + 0.0f;  // -0 becomes 0.
  return value;
}

template <int D>
MoverState<D> character_state(const Built<D>& built, std::size_t i) {
  const Character<D>& character = built.characters[i];
  const auto words =
      built.world.registers().subspan(character.first_register, kCharacterRegisters<D>);
  MoverState<D> state;
  state.position = read_vec<D>(words);
  state.velocity = read_vec<D>(words.subspan(D));
  if (!solver::within(state.position, solver::kPositionMax) ||
      !solver::within(state.velocity, solver::kSpeedMax)) {
    state = {};
    state.position = character.start;
    return state;
  }
  const auto ground = words.subspan(2 * D);
  const Vec<D> ground_velocity = read_vec<D>(ground.subspan(3));
  if (ground[0] != 1 || ground[1] == 0 || !solver::within(ground_velocity, solver::kSpeedMax))
    return state;
  state.grounded = true;
  state.ground = {ground[1] - 1, ground[2]};
  state.ground_velocity = ground_velocity;
  return state;
}

template <int D>
static void append(const Vec<D>& value, std::vector<std::uint32_t>& words) {
  for (int i = 0; i < D; ++i) words.push_back(std::bit_cast<std::uint32_t>(value[i] + 0.0f));
}

template <int D>
static std::vector<std::uint32_t> words_of(const MoverState<D>& state) {
  std::vector<std::uint32_t> words;
  append(state.position, words);
  append(state.velocity, words);
  const bool grounded = state.grounded && state.ground.index != solver::kNone;
  words.push_back(grounded ? 1 : 0);
  words.push_back(grounded ? state.ground.index + 1 : 0);
  words.push_back(grounded ? state.ground.generation : 0);
  append(grounded ? state.ground_velocity : Vec<D>::zero(), words);
  return words;
}

template <int D>
bool set_character_state(Built<D>& built, std::size_t i, const MoverState<D>& state) {
  if (!solver::within(state.position, solver::kPositionMax) ||
      !solver::within(state.velocity, solver::kSpeedMax) ||
      !solver::within(state.ground_velocity, solver::kSpeedMax))
    return false;
  std::uint32_t at = built.characters[i].first_register;
  for (const std::uint32_t word : words_of(state))
    if (!built.world.set_register(at++, word).ok()) return false;
  return true;
}

template <int D>
void start_characters(Built<D>& built) {
  for (std::size_t i = 0; i < built.characters.size(); ++i) {
    MoverState<D> state;
    state.position = built.characters[i].start;
    set_character_state(built, i, state);
  }
}

template <int D>
bool characters_fit(const Built<D>& built) {
  for (std::size_t i = 0; i < built.characters.size(); ++i) {
    const auto found =
        built.world.registers().subspan(built.characters[i].first_register, kCharacterRegisters<D>);
    const std::vector<std::uint32_t> canonical = words_of(character_state(built, i));
    if (!std::equal(found.begin(), found.end(), canonical.begin())) return false;
  }
  return true;
}

/// The state with the velocity that the character has in this tick. Half of the tick's gravity
/// comes before the move and half after it, so that a jump is the parabola it should be.
template <int D>
static MoverState<D> willing(const Character<D>& character, const CharacterWish<D>& wish,
                             const Vec<D>& half_fall, float dt, MoverState<D> state) {
  const Vec<D>& up = character.mover.up;
  Vec<D> wanted = wish.walk - dot(wish.walk, up) * up;
  const float share = length(wanted);
  if (share > 1.0f) wanted = (1.0f / share) * wanted;
  float rise = dot(state.velocity, up);
  const Vec<D> across = state.velocity - rise * up;
  Vec<D> change = character.speed * wanted - across;
  const float most = dt * (state.grounded ? character.acceleration : character.air_acceleration);
  const float much = length(change);
  if (much > most) change = (most / much) * change;
  const bool jumps = wish.jump && state.grounded;
  if (jumps) rise = character.jump_speed;
  state.velocity = across + change + rise * up;
  if (jumps || !state.grounded) state.velocity += half_fall;
  return state;
}

/// Pushes a body, and gives the character what is left of the velocity it `wanted` in that
/// direction: solver::move stops it as at a wall, but after an inelastic push both go on together.
template <int D>
static void push(solver::World<D>& world, const solver::MoverImpulse<D>& given,
                 const Vec<D>& wanted, const Vec<D>& up, MoverState<D>& state) {
  const solver::Body<D>& body = world.state().bodies[given.body.index];
  const Vec<D> arm = given.point - body.position;
  const bool pushed = world.apply_impulse(given.body, given.impulse).ok() &&
                      world.apply_angular_impulse(given.body, moment(arm, given.impulse)).ok();
  // What would leave the bounds of a world stays as it is, the same everywhere.
  const float strength = length(given.impulse);
  if (!pushed || !(strength > 0.0f)) return;
  const Vec<D> direction = (1.0f / strength) * given.impulse;
  const float speed = dot(state.velocity + state.ground_velocity, direction);
  const float common = solver::min(dot(wanted, direction),
                                   dot(body.velocity + spin_cross(body.spin, arm), direction));
  if (!(common > speed)) return;
  state.velocity += (common - speed) * direction;
  if (state.grounded) state.velocity -= dot(state.velocity, up) * up;
}

template <int D>
static void move_character(Built<D>& built, std::size_t i, const CharacterWish<D>& wish) {
  const Character<D>& character = built.characters[i];
  const float dt = built.world.tick_s();
  const Vec<D> half_fall = 0.5f * dt * character.gravity_scale * built.world.state().header.gravity;
  const MoverState<D> before = character_state(built, i);
  const MoverState<D> start = willing(character, wish, half_fall, dt, before);
  const solver::MoverStep<D> step = move(built.world.state(), character.mover, start, dt);
  MoverState<D> after = step.state;
  const Vec<D> wanted = start.velocity + start.ground_velocity;
  for (const solver::MoverImpulse<D>& impulse : step.impulses)
    push(built.world, impulse, wanted, character.mover.up, after);
  if (!after.grounded) after.velocity += half_fall;
  if (set_character_state(built, i, after)) return;
  MoverState<D> rest;
  rest.position = before.position;
  set_character_state(built, i, rest);
}

template <int D>
void move_characters(Built<D>& built, std::span<const CharacterWish<D>> wishes) {
  for (std::size_t i = 0; i < built.characters.size(); ++i) move_character(built, i, wishes[i]);
}

template Character<2> make_character(const SceneCharacter&, const std::string&,
                                     std::vector<Mistake>&);
template Character<3> make_character(const SceneCharacter&, const std::string&,
                                     std::vector<Mistake>&);
template MoverState<2> character_state(const Built<2>&, std::size_t);
template MoverState<3> character_state(const Built<3>&, std::size_t);
template bool set_character_state(Built<2>&, std::size_t, const MoverState<2>&);
template bool set_character_state(Built<3>&, std::size_t, const MoverState<3>&);
template void start_characters(Built<2>&);
template void start_characters(Built<3>&);
template bool characters_fit(const Built<2>&);
template bool characters_fit(const Built<3>&);
template void move_characters(Built<2>&, std::span<const CharacterWish<2>>);
template void move_characters(Built<3>&, std::span<const CharacterWish<3>>);

}  // namespace cycloid::scenes
