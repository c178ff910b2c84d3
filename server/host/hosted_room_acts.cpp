#include <cerrno>
#include <system_error>
#include <utility>

#include "server/host/hosted_room.hpp"
#include "server/host/process_time.hpp"
#include "server/log/new_file.hpp"

// What others ask of a room: each act runs on the room's strand.

namespace cycloid::server {
namespace {

constexpr int kConflict = 409;
constexpr int kNotFound = 404;

ActResult write_state_file(const std::string& path, const std::vector<std::byte>& state) {
  const int error = write_new_file(*system_disk(), path, state);
  if (error == 0) return {};
  return {error == EEXIST ? kConflict : kCannotWrite,
          "file: " + path + ": cannot be written: " + std::generic_category().message(error)};
}

}  // namespace

void HostedRoom::act(LifeAct act, std::string reason, std::chrono::milliseconds deadline,
                     Done done) {
  auto work = [self = shared_from_this(), act, reason = std::move(reason), deadline,
               done = std::move(done)] {
    HostedRoom& room = *self;
    if (!room.room_) return answer(done, {kConflict, "the room has ended"});
    const bool was_paused = room.life_.stage() == LifeStage::kPaused;
    if (std::string why = room.life_.apply(act); !why.empty()) {
      return answer(done, {kConflict, std::move(why)});
    }
    room.publish_stage();
    room.room_->lock(room.life_.locked());
    if (act == LifeAct::kPause) room.room_->pause(reason);
    if (was_paused && room.life_.stage() != LifeStage::kPaused) room.room_->resume();
    room.site_.logger->info("room {}: {}{}{}", room.name_, life_act_name(act),
                            reason.empty() ? "" : ": ", reason);
    if (act == LifeAct::kDrain) room.drain_within(deadline, reason);
    if (act == LifeAct::kEnd) room.end(reason);
    answer(done, {});
    room.timer_.cancel();  // Goes on at once in its new stage.
    if (act == LifeAct::kEnd) room.wait_for_last();
  };
  asio::post(strand_, std::move(work));
}

void HostedRoom::drain_within(std::chrono::milliseconds deadline, const std::string& reason) {
  drain_at_ns_ = process_now_ns() + std::chrono::nanoseconds(deadline).count();
  drain_reason_ = reason;
  room_->announce_drain(deadline, reason);
  wake_sessions();
}

void HostedRoom::hasten_drain(std::string reason, std::chrono::milliseconds deadline) {
  asio::post(strand_, [self = shared_from_this(), reason = std::move(reason), deadline] {
    HostedRoom& room = *self;
    if (!room.room_ || room.life_.stage() != LifeStage::kDraining) return;
    const std::int64_t at_ns = process_now_ns() + std::chrono::nanoseconds(deadline).count();
    if (at_ns >= room.drain_at_ns_) return;
    room.site_.logger->info("room {}: ends within {} ms: {}", room.name_, deadline.count(), reason);
    room.drain_within(deadline, reason);
    room.timer_.cancel();  // The end may be now.
  });
}

void HostedRoom::ask(Done done, std::function<ActResult(Room&)> question) {
  auto work = [self = shared_from_this(), done = std::move(done), question = std::move(question)] {
    if (!self->room_ || self->life_.stage() == LifeStage::kEnded) {
      return answer(done, {kConflict, "the room has ended"});
    }
    ActResult result = question(*self->room_);
    self->wake_sessions();
    answer(done, std::move(result));
  };
  asio::post(strand_, std::move(work));
}

void HostedRoom::kick(std::uint16_t seat, std::string reason, Done done) {
  ask(std::move(done), [seat, reason = std::move(reason)](Room& room) {
    if (room.kick(seat, reason)) return ActResult{};
    return ActResult{kNotFound, "seat: nobody sits in " + std::to_string(seat)};
  });
}

void HostedRoom::reserve(std::uint16_t seat, std::string identity, std::uint64_t ticks, Done done) {
  ask(std::move(done), [seat, identity = std::move(identity), ticks](Room& room) {
    if (room.reserve(seat, identity, ticks)) return ActResult{};
    return ActResult{kConflict,
                     "seat: " + std::to_string(seat) + " is held or waits for its player"};
  });
}

void HostedRoom::rewind(std::uint64_t tick, Done done) {
  ask(std::move(done), [tick](Room& room) {
    if (room.rewind(tick)) return ActResult{};
    return ActResult{kConflict, "tick: " + std::to_string(tick) + " is not kept; the room is at " +
                                    std::to_string(room.tick())};
  });
}

void HostedRoom::rotate_log(Done done) {
  ask(std::move(done), [this](Room&) { return log_->rotate(); });
}

void HostedRoom::set_limits(const Limits& limits) {
  ask({}, [limits](Room& room) {
    room.set_limits(limits);
    return ActResult{};
  });
}

void HostedRoom::write_snapshot(std::string path, Done done) {
  auto work = [self = shared_from_this(), path = std::move(path), done = std::move(done)] {
    if (!self->room_) return answer(done, {kConflict, "the room has ended"});
    std::vector<std::byte> state;
    self->room_->encode_state(state);
    // The disk is for another thread; this one makes ticks.
    asio::post(self->site_.slow, [path, done, state = std::move(state)] {
      answer(done, write_state_file(path, state));
    });
  };
  asio::post(strand_, std::move(work));
}

void HostedRoom::hurry(std::string reason) {
  asio::post(strand_, [self = shared_from_this(), reason = std::move(reason)] {
    self->hurries_ = true;
    if (!self->room_ || self->life_.stage() == LifeStage::kEnded) return;
    self->end(reason);
    self->timer_.cancel();
    self->wait_for_last();
  });
}

}  // namespace cycloid::server
