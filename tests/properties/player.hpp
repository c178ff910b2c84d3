#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/properties/scenery.hpp"

namespace cycloid::properties {

/// What a call answered.
struct Answer {
  solver::Code code = solver::Code::kOk;
  std::string field;
  int index = -1;
  std::uint32_t id_index = 0;
  std::uint32_t id_generation = 0;
  friend bool operator==(const Answer&, const Answer&) = default;
};
std::string text_of(const Answer& answer);
Answer answer_of(const solver::Error& error);

/// The one that `choice` names, or an id that was never given out.
template <class Id>
Id one_of(const std::vector<Id>& ids, std::uint32_t choice) {
  return ids.empty() ? Id{} : ids[choice % ids.size()];
}

/// What lives in a world, and what was already destroyed with something else.
struct Alive {
  std::vector<solver::BodyId> bodies;
  std::vector<solver::JointId> joints;
  std::vector<solver::ParticleId> particles;
  std::vector<solver::LinkId> links;
  std::vector<solver::PinId> pins;
};

/// A state to go back to, and all that was done since then.
template <int D>
struct Past {
  solver::WorldState<D> state;
  Alive alive;
  bool destroyed = false;
  std::vector<Command> since;
};

/// A fault in the test's own handling of a restored state, to show that the test would find one in
/// the solver's.
enum class Flaw : std::uint8_t {
  kNone,
  kLowestBit,         ///< One bit of one velocity.
  kForgottenForces,   ///< What waits for the next tick is gone.
  kFreeListReversed,  ///< Seen by the next ids alone.
  kForgottenMemory,   ///< Warm starting: seen by the next tick of what touches.
};

/// Plays the commands of a case on one world and knows what is alive in it.
template <int D>
class Player {
 public:
  /// @param revisits  Whether kRevisit is obeyed, and with which flaw.
  Player(const Case& example, const Setting& setting, bool revisits, Flaw flaw);

  /// Any command but kStep. An answer for each call that it made.
  std::vector<Answer> obey(const Command& command);
  Answer step();
  /// The state is saved and comes back, and with it goes all that the world keeps beside it.
  void forget();

  const solver::World<D>& world() const { return *world_; }
  /// Whether the events of the coming tick are those of a run without restores: which contacts
  /// destroyed bodies had is told once and is no part of the state.
  bool has_all_events() const { return !destroyed_ || !restored_; }
  /// Why a restore failed; "" where none did.
  const std::string& complaint() const { return complaint_; }

 private:
  /// Notes the id, if there is one.
  template <class Id>
  Answer keep(const solver::Result<Id>& result, std::vector<Id>& ids) {
    if (!result.ok()) return answer_of(result.error());
    ids.push_back(result.value());
    return {solver::Code::kOk, "", -1, result.value().index, result.value().generation};
  }
  /// What is gone is chosen no more, whoever took it away.
  template <class Id>
  Answer drop(solver::Error error, std::uint32_t choice, std::vector<Id>& ids) {
    const bool gone = error.ok() || error.code == solver::Code::kUnknownId;
    if (gone && !ids.empty())
      ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(choice % ids.size()));
    return answer_of(error);
  }
  Answer create(const Piece<D>& piece);
  std::vector<Answer> create_all(const std::vector<Piece<D>>& pieces);
  std::vector<Answer> create_chain(const Command& command);
  std::vector<Answer> create_cloth(const Command& command);
  std::vector<Answer> obey_anew(const Command& command);
  Answer obey_body(const Command& command, solver::BodyId id);
  Answer obey_joint(const Command& command);
  Answer obey_particle(const Command& command);
  Answer obey_world(const Command& command);
  void revisit(const Command& command);
  void rest_and_trim(const Command& command);
  void edit_and_restore(const Command& command);
  void change_places();
  void replay();
  void damage();
  void look() const;
  std::unique_ptr<solver::World<D>> make_world() const;

  const Case& example_;
  Setting setting_;
  bool revisits_;
  Flaw flaw_;
  std::unique_ptr<solver::World<D>> world_;
  std::unique_ptr<solver::World<D>> stranger_;
  std::unique_ptr<solver::World<D>> twin_;
  Alive alive_;
  std::unique_ptr<Past<D>> past_;
  std::uint32_t traced_ = 0;  ///< Ticks that will be.
  bool destroyed_ = false;
  bool restored_ = false;
  std::string complaint_;
};

}  // namespace cycloid::properties
