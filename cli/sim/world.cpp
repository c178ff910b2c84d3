#include "cli/sim/world.hpp"

#include <algorithm>
#include <list>
#include <utility>

#include "cli/sim/client.hpp"
#include "cli/sim/hostile.hpp"

namespace cycloid::sim {
namespace {

constexpr std::int64_t kStepNs = 2 * kMillisecond;
/// A server may need so long to see that a peer is gone, and its place to be free again, beside the
/// timeouts of the run.
constexpr std::int64_t kConvergenceSlackNs = 10 * kSecond;
/// How long all go on in sync, and then how long a goodbye takes at most.
constexpr std::int64_t kTogetherNs = kSecond;
constexpr std::int64_t kGoodbyeNs = 4 * kSecond;

class World {
 public:
  World(const Settings& settings, Narrator narrate)
      : settings_(settings),
        scene_(*scene_of(settings.scene)),
        root_(settings.seed),
        host_(settings_, scene_, root_.fork(1), chronicle_) {
    chronicle_.narrate = std::move(narrate);
    for (std::size_t room = 0; room < settings_.rooms; ++room) people(room);
    draw_storms();
  }

  SimReport run() {
    run_for(faults_ns());
    calm();
    const std::int64_t begin = chronicle_.now_ns;
    converge();
    SimReport report;
    if (!chronicle_.violation()) report.convergence_ns = chronicle_.now_ns - begin;
    run_for(kTogetherNs);
    part();
    report.seed = settings_.seed;
    report.violation = chronicle_.violation();
    report.digest = chronicle_.digest();
    report.virtual_ns = chronicle_.now_ns;
    for (std::size_t room = 0; room < host_.rooms(); ++room) add_room(room, report);
    report.chronicle = chronicle_;
    return report;
  }

 private:
  std::int64_t faults_ns() const {
    return static_cast<std::int64_t>(settings_.ticks * 1'000'000'000'000 /
                                     settings_.tick_rate_millihertz);
  }

  /// From a state that is kept to when a spectator may see it, in the worst case.
  std::int64_t sees_late_ns() const {
    if (settings_.spectators == 0 || settings_.spectator_delay_ticks == 0) return 0;
    const std::uint64_t ticks = settings_.spectator_delay_ticks + settings_.limits.keyframe_ticks;
    return static_cast<std::int64_t>(ticks * 1'000'000'000'000 / settings_.tick_rate_millihertz);
  }

  void people(std::size_t room) {
    const std::uint64_t base = 1000 * (room + 1);
    Random random = root_.fork(base);
    const auto seats = static_cast<std::uint32_t>(scene_.seats.size());
    const std::uint32_t players = std::min(settings_.players, seats);
    for (std::uint32_t i = 0; i < players + settings_.spectators; ++i) {
      Persona persona;
      persona.room = room;
      persona.name = "client " + std::to_string(room) + "." + std::to_string(i);
      if (random.chance(settings_.snapshots_of_million)) persona.mode = protocol::Mode::kSnapshot;
      const bool quantised = root_.fork(base + 300 + i).chance(settings_.quantised_of_million);
      if (quantised && persona.mode == protocol::Mode::kSnapshot) {
        persona.profile = protocol::Profile::kQuantised;
      }
      persona.address = server::PeerAddress::v4(
          {10, static_cast<std::uint8_t>(room), 0, static_cast<std::uint8_t>(i + 1)});
      if (i >= players) persona.seat_wish = protocol::kSpectator;
      if (i < players && !settings_.any_seat) persona.seat_wish = static_cast<std::int32_t>(i);
      clients_.emplace_back(settings_, scene_, persona, root_.fork(base + 100 + i), host_,
                            chronicle_);
    }
    const auto trouble = [&](Hostile::Kind kind, std::uint64_t name) {
      hostiles_.emplace_back(settings_, scene_, kind, room, root_.fork(base + name), host_,
                             chronicle_);
    };
    for (std::uint32_t i = 0; i < settings_.hostiles; ++i) {
      trouble(Hostile::Kind::kStranger, 500 + i);
    }
    for (std::uint32_t i = 0; i < settings_.troublemakers; ++i) {
      trouble(Hostile::Kind::kTroublemaker, 700 + i);
    }
  }

  void draw_storms() {
    Random random = root_.fork(2);
    for (std::uint32_t i = 0; i < settings_.client.storms; ++i) {
      storms_ns_.push_back(random.between(0, faults_ns()));
    }
    std::sort(storms_ns_.begin(), storms_ns_.end(), std::greater<>());  // Total order: integers.
  }

  void step() {
    chronicle_.now_ns += kStepNs;
    if (!storms_ns_.empty() && chronicle_.now_ns >= storms_ns_.back()) {
      storms_ns_.pop_back();
      chronicle_.count(Event::kStorm);
      for (SimClient& client : clients_) client.storm();
    }
    for (Hostile& hostile : hostiles_) hostile.step();
    for (SimClient& client : clients_) client.step();
    host_.step(kStepNs);
  }

  void run_for(std::int64_t span_ns) {
    const std::int64_t end = chronicle_.now_ns + span_ns;
    while (chronicle_.now_ns < end && !chronicle_.violation()) step();
  }

  void calm() {
    chronicle_.quiet = true;
    chronicle_.note("the faults are over");
    storms_ns_.clear();
    host_.calm();
    for (Hostile& hostile : hostiles_) hostile.calm();
    for (SimClient& client : clients_) client.calm();
  }

  std::string lacks() const {
    for (const SimClient& client : clients_) {
      if (const std::string what = client.lacks(); !what.empty()) return client.name() + " " + what;
    }
    return "";
  }

  /// Until all are in sync at once. The longest way there: a client notices that its connection is
  /// dead, and the server that the client is gone.
  void converge() {
    const std::int64_t most = settings_.client.silence_ns + settings_.limits.idle.count() +
                              settings_.limits.handshake.count() + settings_.limits.resume.count() +
                              kConvergenceSlackNs + sees_late_ns();
    const std::int64_t end = chronicle_.now_ns + most;
    while (!chronicle_.violation() && !lacks().empty()) {
      if (chronicle_.now_ns > end) {
        chronicle_.violate(
            Invariant::kLiveness,
            lacks() + ", " + std::to_string(most / kMillisecond) + " ms after the faults ended");
        return;
      }
      step();
    }
  }

  /// The match ends in order: everybody is told, the logs are whole.
  void part() {
    if (chronicle_.violation()) return;
    if (const std::string what = lacks(); !what.empty()) {
      chronicle_.violate(Invariant::kLiveness, what + ", though nothing happened");
    }
    host_.drain();
    run_for(kGoodbyeNs);
    if (chronicle_.violation()) return;
    host_.check_at_end();
    for (const SimClient& client : clients_) {
      if (client.ended()) continue;
      chronicle_.violate(Invariant::kLiveness, client.name() + " was not told the end");
    }
  }

  void add_room(std::size_t room, SimReport& report) {
    for (std::size_t era = 0; era < host_.room(room).eras(); ++era) {
      const Ledger& ledger = host_.room(room).ledger(era);
      report.ticks += ledger.ticks();
      report.confirmed = scramble(report.confirmed ^ ledger.digest());
    }
  }

  Settings settings_;
  scenes::Scene scene_;
  Random root_;
  Chronicle chronicle_;
  Host host_;
  std::list<SimClient> clients_;
  std::list<Hostile> hostiles_;
  std::vector<std::int64_t> storms_ns_;
};

}  // namespace

SimReport simulate(const Settings& settings, const Narrator& narrate) {
  return World(settings, narrate).run();
}

}  // namespace cycloid::sim
