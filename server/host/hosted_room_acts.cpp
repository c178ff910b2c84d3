#include <utility>

#include "server/host/hosted_room.hpp"
#include "server/host/process_time.hpp"

// What others ask of a room: each act runs on the room's strand.

namespace cycloid::server {
namespace {

constexpr int kConflict = 409;

void answer(const HostedRoom::Done& done, ActResult result) {
  if (done) done(std::move(result));
}

}  // namespace

void HostedRoom::act(LifeAct act, std::string reason, std::chrono::milliseconds deadline,
                     Done done) {
  auto work = [self = shared_from_this(), act, reason = std::move(reason), deadline,
               done = std::move(done)] {
    HostedRoom& room = *self;
    if (!room.room_) return answer(done, {kConflict, "the room has ended"});
    const std::int64_t now_ns = process_now_ns();
    const bool was_paused = room.life_.stage() == LifeStage::kPaused;
    if (std::string why = room.life_.apply(act); !why.empty()) {
      return answer(done, {kConflict, std::move(why)});
    }
    room.publish_stage();
    if (act == LifeAct::kPause) room.clock_.pause(now_ns);
    if (was_paused && act != LifeAct::kLock && act != LifeAct::kUnlock) {
      room.clock_.resume(now_ns, room.tick_ns());
    }
    room.site_.logger->info("room {}: {}{}{}", room.name_, life_act_name(act),
                            reason.empty() ? "" : ": ", reason);
    if (act == LifeAct::kDrain) {
      room.drain_at_ns_ = now_ns + std::chrono::nanoseconds(deadline).count();
      room.drain_reason_ = reason;
      room.say_draining(now_ns);
    }
    if (act == LifeAct::kEnd) room.end(reason);
    answer(done, {});
    room.timer_.cancel();  // Goes on at once in its new stage.
    if (act == LifeAct::kEnd) room.wait_for_last();
  };
  asio::post(strand_, std::move(work));
}

void HostedRoom::say_draining(std::int64_t now_ns) {
  protocol::RoomNotice notice;
  notice.kind = protocol::NoticeKind::kDraining;
  notice.tick = room_->tick();
  notice.value = static_cast<std::uint64_t>(std::max<std::int64_t>(drain_at_ns_ - now_ns, 0)) /
                 1'000'000;
  notice.text = drain_reason_;
  const auto message = std::make_shared<const protocol::Bytes>(
      protocol::encode(protocol::ServerMessage(notice)));
  for (const auto& weak : sessions_) {
    if (const auto session = weak.lock()) session->say(message);
  }
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
