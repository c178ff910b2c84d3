#include <utility>

#include "tests/properties/player.hpp"

namespace cycloid::properties {

template <int D>
std::vector<Answer> Player<D>::create_all(const std::vector<Piece<D>>& pieces) {
  std::vector<Answer> answers;
  for (const Piece<D>& piece : pieces) answers.push_back(create(piece));
  return answers;
}

template <int D>
std::vector<Answer> Player<D>::create_chain(const Command& command) {
  std::vector<Answer> answers;
  solver::JointDef<D> def;
  def.kind = command.b % 8 == 6 ? solver::JointKind::kWeld : solver::JointKind::kRevolute;
  solver::Vec<D> last = solver::Vec<D>::zero();
  for (const Piece<D>& piece : chain_of<D>(command)) {
    answers.push_back(create(piece));
    if (answers.back().code != solver::Code::kOk) return answers;
    def.body_b = alive_.bodies.back();
    def.anchor_a = piece.body.position - last;
    if (answers.size() > 1) answers.push_back(keep(world_->create_joint(def), alive_.joints));
    def.body_a = def.body_b;
    last = piece.body.position;
  }
  return answers;
}

template <int D>
std::vector<Answer> Player<D>::create_cloth(const Command& command) {
  std::vector<Answer> answers;
  const Cloth<D> cloth = cloth_of<D>(command);
  const std::size_t before = alive_.particles.size();
  for (const solver::ParticleDef<D>& particle : cloth.particles) {
    answers.push_back(keep(world_->create_particle(particle), alive_.particles));
    if (answers.back().code != solver::Code::kOk) return answers;
  }
  for (const auto& [one, other] : cloth.links)
    answers.push_back(
        keep(world_->create_link({alive_.particles[before + one], alive_.particles[before + other],
                                  cloth.length, cloth.compliance}),
             alive_.links));
  if (command.v[6] >= 0)
    answers.push_back(
        keep(world_->create_pin({alive_.particles[before], one_of(alive_.bodies, command.b), {}}),
             alive_.pins));
  return answers;
}

/// What scenery.hpp defines.
template <int D>
std::vector<Answer> Player<D>::obey_anew(const Command& command) {
  switch (command.op) {
    case Op::kCreateCrowd:
      return create_all(crowd_of<D>(command));
    case Op::kCreateLand:
      return {create(land_of<D>(command))};
    case Op::kCreateSolid:
      return {create(solid_of<D>(command))};
    case Op::kCreateCloth:
      return create_cloth(command);
    default: {
      solver::JointDef<D> def = drive_of<D>(command);
      def.body_a = one_of(alive_.bodies, command.a);
      def.body_b = one_of(alive_.bodies, command.b);
      if (def.body_a == def.body_b) def.body_b = one_of(alive_.bodies, command.b + 1);
      return {keep(world_->create_joint(def), alive_.joints)};
    }
  }
}

template <int D>
void Player<D>::rest_and_trim(const Command& command) {
  world_->rest_workers(command.a % 2 == 1);
  if (command.a % 4 < 2) world_->trim();
}

/// What the edits made the world remember must go with them.
template <int D>
void Player<D>::edit_and_restore(const Command& command) {
  std::unique_ptr<Past<D>> past = std::move(past_);
  const Alive alive = alive_;
  const bool destroyed = destroyed_;
  solver::WorldState<D> saved;
  world_->save(saved);
  Command edit = command;
  for (std::uint32_t i = 0; i < 3; ++i) {
    edit.op =
        static_cast<Op>((command.a + 64 * i + static_cast<std::uint32_t>(command.v[i] + 100)) %
                        static_cast<std::uint32_t>(Op::kCount));
    if (edit.op != Op::kRevisit && edit.op != Op::kStep) (void)obey(edit);
    if (command.v[3] >= 0 || i == 2) (void)world_->step();
  }
  world_->restore(saved);
  alive_ = alive;
  destroyed_ = destroyed;
  past_ = std::move(past);
}

/// Each of the two has kept things of its own from when it last was the one that is played.
template <int D>
void Player<D>::change_places() {
  if (twin_ == nullptr) twin_ = make_world();
  solver::WorldState<D> saved;
  world_->save(saved);
  twin_->restore(saved);
  std::swap(world_, twin_);
}

/// The calls since then come to the same again, whatever the world has seen of what comes.
template <int D>
void Player<D>::replay() {
  const std::unique_ptr<Past<D>> past = std::move(past_);
  if (past != nullptr) {
    world_->restore(past->state);
    alive_ = past->alive;
    destroyed_ = past->destroyed;
    restored_ = true;
    for (const Command& command : past->since)
      if (command.op == Op::kStep)
        (void)step();
      else
        (void)obey(command);
  }
  past_ = std::make_unique<Past<D>>();
  world_->save(past_->state);
  past_->alive = alive_;
  past_->destroyed = destroyed_;
}

template std::vector<Answer> Player<2>::create_all(const std::vector<Piece<2>>&);
template std::vector<Answer> Player<3>::create_all(const std::vector<Piece<3>>&);
template std::vector<Answer> Player<2>::create_chain(const Command&);
template std::vector<Answer> Player<3>::create_chain(const Command&);
template std::vector<Answer> Player<2>::obey_anew(const Command&);
template std::vector<Answer> Player<3>::obey_anew(const Command&);
template void Player<2>::rest_and_trim(const Command&);
template void Player<3>::rest_and_trim(const Command&);
template void Player<2>::edit_and_restore(const Command&);
template void Player<3>::edit_and_restore(const Command&);
template void Player<2>::change_places();
template void Player<3>::change_places();
template void Player<2>::replay();
template void Player<3>::replay();

}  // namespace cycloid::properties
