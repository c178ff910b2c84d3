#include "bench/load/scenario.hpp"

namespace cycloid::load {
namespace {

using protocol::Mode;
using protocol::Profile;

const char* const kSmallRoom = "room:bodies=64";

ClientGroup lockstep(const char* name, int count, Behaviour behaviour, double after_s = 0.0) {
  return {name, count, Mode::kLockstep, Profile::kExact, behaviour, after_s};
}

ClientGroup snapshots(int count, Profile profile) {
  return {"players", count, Mode::kSnapshot, profile, Behaviour::kPlays, 0.0};
}

Scenario one_room(const char* name, const char* what, std::vector<ClientGroup> groups) {
  return {name, what, kSmallRoom, 1, 2, 1, std::move(groups)};
}

}  // namespace

std::vector<Scenario> scenarios() {
  const ClientGroup players = lockstep("players", 8, Behaviour::kPlays);
  std::vector<Scenario> all = {
      one_room("alone", "One room of 8 players: what the others are held against", {players}),
      one_room("spectators", "1,000 spectators of one room of 8 players",
               {players, lockstep("spectators", 1000, Behaviour::kWatches)}),
      one_room("idle", "10,000 connections that say nothing, beside a room",
               {players, lockstep("idle", 10000, Behaviour::kIdles, 0.5)}),
      one_room("slowloris", "5,000 connections that say a byte a second, beside a room",
               {players, lockstep("dripping", 5000, Behaviour::kDrips, 0.5)}),
      one_room("mute", "100 clients that join and never read, beside a room",
               {players, lockstep("mute", 100, Behaviour::kMute)}),
      one_room("latency", "8 snapshot clients that act at any moment",
               {snapshots(8, Profile::kExact)}),
  };
  all.push_back(
      {"rooms", "100 rooms of 8 players and 64 bodies", kSmallRoom, 100, 2, 1, {players}});
  all.push_back({"big-room",
                 "One room of 200 lockstep players",
                 "seats:200",
                 1,
                 2,
                 1,
                 {lockstep("players", 200, Behaviour::kPlays)}});
  all.push_back({"snapshots",
                 "128 snapshot clients of one room of 128 bodies, quantised",
                 "seats:128",
                 1,
                 2,
                 1,
                 {snapshots(128, Profile::kQuantised)}});
  return all;
}

double ScenarioResult::own_overruns() const {
  double beside_control = 0.0;
  for (const Stretch& stretch : overruns)
    if (stretch.control_missed()) beside_control += stretch.behind;
  return catch_up_ticks - beside_control;
}

std::vector<std::string> failures_of(const ScenarioResult& result) {
  std::vector<std::string> failures;
  const auto number = [](double value) {
    return std::to_string(static_cast<std::uint64_t>(value));
  };
  for (const GroupResult& group : result.groups) {
    const ClientTally& tally = group.tally;
    const auto clients = static_cast<std::uint64_t>(group.clients);
    const bool joins = group.behaviour != Behaviour::kIdles && group.behaviour != Behaviour::kDrips;
    const auto say = [&](std::uint64_t count, const char* what) {
      failures.push_back(group.name + ": " + std::to_string(count) + " of " +
                         std::to_string(clients) + what);
    };
    if (joins && tally.joined < clients) say(clients - tally.joined, " never joined");
    if (tally.refused != 0) say(tally.refused, (" were refused: " + tally.last_refusal).c_str());
    // Who reads nothing may be let go; the server has to, where much waits.
    const bool reads = group.behaviour != Behaviour::kMute;
    if (reads && tally.closed > tally.refused)
      say(tally.closed - tally.refused, " lost their connection");
  }
  if (result.ticks <= 0.0) failures.push_back("no room made a tick");
  if (result.catch_up_ticks > 0.0) {
    failures.push_back(number(result.catch_up_ticks) + " of " + number(result.ticks) +
                       " ticks began in the time of the next, " + number(result.own_overruns()) +
                       " of them while the bare timer was in time");
  }
  return failures;
}

}  // namespace cycloid::load
