#include "bench/load/scenario.hpp"

namespace cycloid::load {

using protocol::Mode;
using protocol::Profile;

std::vector<Scenario> scenarios() {
  const ClientGroup players{"players", 8, Mode::kLockstep, Profile::kExact, Behaviour::kPlays, 0.0};
  const auto group = [](const char* name, int count, Mode mode, Profile profile,
                        Behaviour behaviour, double after_s) {
    return ClientGroup{name, count, mode, profile, behaviour, after_s};
  };
  const ClientGroup watchers =
      group("spectators", 1000, Mode::kLockstep, Profile::kExact, Behaviour::kWatches, 0.0);
  return {
      {"rooms", "100 rooms of 8 players and 64 bodies", "room:bodies=64", 100, 2, 1, {players}},
      {"big-room",
       "One room of 200 lockstep players",
       "seats:200",
       1,
       2,
       1,
       {group("players", 200, Mode::kLockstep, Profile::kExact, Behaviour::kPlays, 0.0)}},
      {"snapshots",
       "128 snapshot clients of one room of 200 bodies, quantised",
       "seats:128",
       1,
       2,
       1,
       {group("players", 128, Mode::kSnapshot, Profile::kQuantised, Behaviour::kPlays, 0.0)}},
      {"spectators",
       "1,000 spectators of one room of 8 players",
       "room:bodies=64",
       1,
       2,
       1,
       {players, watchers}},
      {"idle",
       "10,000 connections that say nothing, beside a room",
       "room:bodies=64",
       1,
       2,
       1,
       {players, group("idle", 10000, Mode::kLockstep, Profile::kExact, Behaviour::kIdles, 0.5)}},
      {"slowloris",
       "5,000 connections that say a byte a second, beside a room",
       "room:bodies=64",
       1,
       2,
       1,
       {players,
        group("dripping", 5000, Mode::kLockstep, Profile::kExact, Behaviour::kDrips, 0.5)}},
      {"mute",
       "100 clients that join and never read, beside a room",
       "room:bodies=64",
       1,
       2,
       1,
       {players, group("mute", 100, Mode::kLockstep, Profile::kExact, Behaviour::kMute, 0.0)}},
      {"latency",
       "8 snapshot clients that act at any moment",
       "room:bodies=64",
       1,
       2,
       1,
       {group("players", 8, Mode::kSnapshot, Profile::kExact, Behaviour::kPlays, 0.0)}},
      {"alone",
       "One room of 8 players: what the others are held against",
       "room:bodies=64",
       1,
       2,
       1,
       {players}},
  };
}

}  // namespace cycloid::load
