#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/match.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {

/// One of two worlds that should be the same: stepped by this program, or by another.
class Suspect {
 public:
  virtual ~Suspect() = default;
  virtual std::string name() const = 0;
  /// As far as tick `last_tick`.
  virtual Course course(std::uint64_t last_tick) const = 0;
  virtual TickTrace trace(std::uint64_t tick, const TraceDetail& detail) const = 0;
};

/// A match as this program steps it.
std::unique_ptr<Suspect> suspect_here(std::string name, const Match& match);

/// Another build of this program.
struct OtherBuild {
  std::string program;
  std::string runner;  ///< What starts it: "qemu-aarch64 -L /usr/aarch64-linux-gnu"; "": nothing.
};

/// A match as another build steps it: of a log, what is good here. Its calls throw a Failure with
/// kExitIo and the last words of the program where it does not do what it should.
std::unique_ptr<Suspect> suspect_there(const OtherBuild& build, const Match& match);

/// Where in a tick two worlds part.
struct Blame {
  std::uint64_t tick = 0;
  std::string digest_a;
  std::string digest_b;
  std::optional<solver::TracePoint> at;    ///< The first phase that differs.
  std::size_t phases_equal = 0;            ///< Before it.
  std::vector<std::string> objects;        ///< All that differ after that phase.
  std::vector<solver::Difference> fields;  ///< Of the first of them.
  std::string other;  ///< Where not the values differ but what there is, in a sentence.
};

/// The first tick after which the digests differ, or none. @pre both begin after one tick
std::optional<std::uint64_t> first_difference(const Course& a, const Course& b);

/// Traces one tick on both sides, ever closer: phases, objects of the first phase that differs,
/// fields of the first object.
/// @param fields  How many to name at most.
Blame blame_tick(const Suspect& a, const Suspect& b, std::uint64_t tick, std::size_t fields);

/// Members "tick", "phase", "object", "fields" and so on.
Json to_json(const Blame& blame);
void print_blame(const Blame& blame, const std::string& name_a, const std::string& name_b);

}  // namespace cycloid::cli
