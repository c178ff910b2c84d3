#include "tests/properties/play.hpp"

#include <algorithm>
#include <sstream>

#include "solver/encoding.hpp"

namespace cycloid::properties {

void Played::add(const Played& other) {
  cases += other.cases;
  ticks += other.ticks;
  calls += other.calls;
  refused += other.refused;
  faulted += other.faulted;
  contacts += other.contacts;
  joints += other.joints;
  asleep += other.asleep;
  particles += other.particles;
  links += other.links;
  crowded_ticks += other.crowded_ticks;
  resting_ticks += other.resting_ticks;
  paced_ticks += other.paced_ticks;
}

namespace {

/// Two runs of one case.
template <int D>
class Pair {
 public:
  Pair(const Case& example, Flaw flaw)
      : example_(example),
        one_(example, example.one, false, Flaw::kNone),
        other_(example, example.other, true, flaw) {}

  Played play() {
    played_.cases = 1;
    if (!equal("the start")) return played_;
    for (std::size_t i = 0; i < example_.commands.size(); ++i) {
      const std::string place = "command " + std::to_string(i);
      const Command& command = example_.commands[i];
      const bool equal = command.op == Op::kStep ? step(command, place) : obey(command, place);
      if (!equal) return played_;
    }
    finish();
    return played_;
  }

 private:
  bool fail(const std::string& place, const std::string& what) {
    std::ostringstream text;
    text << place << ", tick " << one_.world().tick() << ": " << what;
    for (const solver::Difference& at :
         solver::differences(one_.world().state(), other_.world().state(), 5))
      text << "\n  " << at.object << " " << at.field << ": " << at.value_a << " and " << at.value_b;
    played_.failure = text.str();
    return false;
  }

  bool equal(const std::string& place) {
    if (!other_.complaint().empty()) return fail(place, other_.complaint());
    if (one_.world().digest() != other_.world().digest()) return fail(place, "the digests differ");
    return true;
  }

  bool obey(const Command& command, const std::string& place) {
    const std::vector<Answer> answers = one_.obey(command);
    const std::vector<Answer> others = other_.obey(command);
    for (const Answer& answer : answers) {
      ++played_.calls;
      if (answer.code != solver::Code::kOk) ++played_.refused;
    }
    if (answers != others) {
      std::string words = "the answers differ:";
      for (std::size_t i = 0; i < std::min(answers.size(), others.size()); ++i)
        if (answers[i] != others[i])
          words += " " + text_of(answers[i]) + " and " + text_of(others[i]);
      return fail(place, words);
    }
    return equal(place);
  }

  bool step(const Command& command, const std::string& place) {
    for (std::uint32_t i = 0; i < 1 + command.a % 12; ++i) {
      const bool all_events = other_.has_all_events();
      const Answer answer = one_.step();
      const Answer other = other_.step();
      if (answer != other)
        return fail(place, "step: " + text_of(answer) + " and " + text_of(other));
      if (!equal(place)) return false;
      if (answer.code != solver::Code::kOk) return true;  // In its fault state it makes no tick.
      if (all_events &&
          !std::ranges::equal(one_.world().contact_events(), other_.world().contact_events()))
        return fail(place, "the contact events differ");
      count();
    }
    return true;
  }

  void count() {
    const solver::WorldState<D>& state = one_.world().state();
    const solver::Statistics& statistics = one_.world().statistics();
    ++played_.ticks;
    played_.contacts += state.contacts.size();
    played_.joints += state.joints.size() - state.free_joints.size();
    played_.particles += state.particles.size() - state.free_particles.size();
    played_.links += state.links.size() - state.free_links.size();
    played_.asleep += statistics.asleep;
    played_.crowded_ticks += state.contacts.size() > 64 ? 1 : 0;
    played_.resting_ticks += statistics.asleep > 64 ? 1 : 0;
    played_.paced_ticks += statistics.substeps < one_.world().tuning().substeps ? 1 : 0;
  }

  void finish() {
    played_.faulted = one_.world().fault().has_value() ? 1 : 0;
    std::vector<std::byte> bytes;
    std::vector<std::byte> other_bytes;
    one_.world().encode(bytes);
    other_.world().encode(other_bytes);
    if (bytes != other_bytes) fail("the end", "equal digests, but other bits");
    if (solver::digest_encoding(bytes) != one_.world().digest())
      fail("the end", "the digest is not that of the state");
  }

  const Case& example_;
  Player<D> one_;
  Player<D> other_;
  Played played_;
};

}  // namespace

Played play(const Case& example, Flaw flaw) {
  return example.dimension == 2 ? Pair<2>(example, flaw).play() : Pair<3>(example, flaw).play();
}

}  // namespace cycloid::properties
