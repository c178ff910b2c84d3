#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/sim/chronicle.hpp"
#include "cli/sim/disk.hpp"
#include "cli/sim/issuer.hpp"
#include "cli/sim/ledger.hpp"
#include "cli/sim/log.hpp"
#include "cli/sim/session.hpp"
#include "cli/sim/settings.hpp"
#include "scenes/catalogue.hpp"
#include "server/admission/gate.hpp"
#include "server/room/room.hpp"

namespace cycloid::sim {

/// One room of the server's process with a gate of its own, from one start of it to the next. An
/// era is such a stretch: a match of its own, with its own log.
class RoomHost {
 public:
  RoomHost(const Settings& settings, const scenes::Scene& scene, std::size_t number,
           const Random& random, SimDisk& disk, Chronicle& chronicle);

  /// Begins the next era.
  void open();
  void accept(std::shared_ptr<Wire> wire);
  void step(std::int64_t step_ns);
  void rotate_log();
  /// The match goes back to one of its ticks.
  void rewind(Random& random);
  void drain();
  /// The process is gone; `disk` shows already what it has left.
  void die(Death death);

  bool running() const { return room_ && room_->state() == server::RoomState::kRunning; }
  /// Its log is gone, and with its next tick the room will be too, as was asked for.
  bool doomed() const { return room_ && settings_->server.stop_on_log_error && !log_->durable(); }
  /// The room has ended by itself, and all had time to be told: whoever stays makes no difference.
  bool over() const { return room_ && !running() && chronicle_->now_ns >= over_at_ns_; }
  std::uint64_t tick() const { return room_ ? room_->tick() : 0; }
  std::size_t eras() const { return ledgers_.size(); }
  std::size_t era() const { return ledgers_.size() - 1; }
  /// Whether the room has let a connection in, and has not sent it away since.
  bool serves(const Wire& wire) const;
  /// Whether the server has dropped what waited for a connection, and has yet to write the state
  /// that takes its place.
  bool owes_state(const Wire& wire) const;
  Ledger& ledger(std::size_t era) { return *ledgers_[era]; }
  /// Somebody in this era may say digests that are wrong.
  void excuse_desyncs() { desyncs_excused_ = true; }
  /// What its tokens and hellos call it.
  std::string name() const { return "room " + std::to_string(number_); }
  Issuer& issuer() { return issuer_; }
  /// A token that has let its bearer in, in this era; empty where none has.
  std::vector<std::byte>& used_token() { return used_token_; }

  /// The log as it is now, and a read of it with one bit wrong.
  void check_log(std::optional<Death> death);
  /// All that was confirmed in this era, stepped again, and the end of its log from a keyframe on.
  void check_replay();

 private:
  /// Hands a tick to the ledger, then to the log: before any client hears of it.
  class Confirm final : public server::LogSink {
   public:
    Confirm(Ledger& ledger, SimLog& log) : ledger_(&ledger), log_(&log) {}
    void tick(const protocol::LogTick& tick) override {
      ledger_->add(tick);
      log_->tick(tick);
    }
    void close(const protocol::LogFooter& footer) override { log_->close(footer); }
    bool wants_keyframe(std::uint64_t tick) const override { return log_->wants_keyframe(tick); }
    void keyframe(std::uint64_t tick, std::uint64_t digest,
                  std::span<const std::byte> state) override {
      log_->keyframe(tick, digest, state);
    }
    void branch(const protocol::LogTick& from, std::span<const std::byte> state) override {
      ledger_->branch(from.frame.tick, state);
      log_->branch(from, state);
    }
    bool durable() const override { return log_->durable(); }
    std::string error() const override { return log_->error(); }

   private:
    Ledger* ledger_;
    SimLog* log_;
  };

  server::RoomOptions room_options() const;
  server::GateOptions gate_options() const;
  void turn_away_overdue();
  void check_seats();
  void check_room();

  const Settings* settings_;
  const scenes::Scene* scene_;
  std::size_t number_;
  SimDisk* disk_;
  Chronicle* chronicle_;
  std::uint64_t scene_digest_ = 0;
  std::vector<std::byte> scene_bytes_;
  Random secrets_;
  Issuer issuer_;
  std::vector<std::byte> used_token_;
  std::vector<std::unique_ptr<Ledger>> ledgers_;
  std::unique_ptr<SimLog> log_;
  std::unique_ptr<Confirm> confirm_;
  std::unique_ptr<server::Room> room_;
  std::unique_ptr<server::Gate> gate_;
  std::list<Session> sessions_;
  std::uint64_t next_check_tick_ = 0;
  std::int64_t over_at_ns_ = kNever;
  bool desyncs_excused_ = false;
};

/// The server's process and machine.
class Host {
 public:
  Host(const Settings& settings, const scenes::Scene& scene, const Random& random,
       Chronicle& chronicle);

  void step(std::int64_t step_ns);
  void calm();
  void drain();
  bool draining() const { return draining_; }

  /// Whether somebody would accept a connection to the room.
  bool listens(std::size_t room) const {
    return up_ && !paused() && !draining_ && rooms_[room].running();
  }
  void accept(std::shared_ptr<Wire> wire);
  RoomHost& room(std::size_t number) { return rooms_[number]; }
  const RoomHost& room(std::size_t number) const { return rooms_[number]; }
  std::size_t rooms() const { return rooms_.size(); }
  void check_at_end();

 private:
  bool paused() const { return chronicle_->now_ns < paused_until_ns_; }
  void draw_misfortunes();
  void die(Death death);

  const Settings* settings_;
  Random random_;
  Chronicle* chronicle_;
  SimDisk disk_;
  std::vector<RoomHost> rooms_;
  std::vector<std::int64_t> pauses_ns_;  ///< When they begin; the last first.
  std::vector<std::int64_t> deaths_ns_;
  std::vector<std::int64_t> rotations_ns_;
  std::vector<std::int64_t> rewinds_ns_;
  std::int64_t paused_until_ns_ = 0;
  std::int64_t up_at_ns_ = 0;
  bool up_ = false;
  bool draining_ = false;
};

}  // namespace cycloid::sim
