#include "cli/sim/session.hpp"

#include <utility>
#include <variant>

namespace cycloid::sim {
namespace {

constexpr std::int64_t kLinger = kSecond;
constexpr std::size_t kReadBytes = 16384;
/// A last word is not counted, and the message that reaches the bound is.
constexpr std::size_t kBeyondBound = 1024;

bool is_state(const protocol::ServerMessage& message) {
  return std::holds_alternative<protocol::Snapshot>(message) ||
         std::holds_alternative<protocol::SnapshotPart>(message) ||
         std::holds_alternative<protocol::StateDelta>(message);
}

}  // namespace

Session::Session(std::shared_ptr<Wire> wire, server::Room& room, const server::Limits& limits,
                 Plant plant, Chronicle& chronicle)
    : wire_(std::move(wire)),
      room_(&room),
      limits_(limits),
      plant_(plant),
      chronicle_(&chronicle),
      tamper_(plant),
      id_(room.connect()) {}

void Session::step(std::int64_t step_ns) {
  if (closed_) return;
  if (wire_->up.is_reset()) return close();
  read();
  if (!closed_) write();
  if (closed_) return;
  if (room_->wants_close(id_) && linger_until_ns_ == kNever) {
    linger_until_ns_ = chronicle_->now_ns + kLinger;
  }
  if (chronicle_->now_ns >= linger_until_ns_) return close();

  if (!answered_) greeting_ns_ += step_ns;
  const std::int64_t most = limits_.handshake.count() + kLinger + kSecond / 4;
  if (greeting_ns_ > most) {
    chronicle_->violate(Invariant::kDeadline, name() + " said no hello and is still there after " +
                                                  std::to_string(greeting_ns_ / kMillisecond) +
                                                  " ms");
  }
}

void Session::read() {
  while (!reader_done_ && room_->wants_bytes(id_)) {
    const auto bytes = wire_->up.read(kReadBytes);
    if (bytes.empty()) break;
    receive(bytes);
  }
  if (reader_done_ || !wire_->up.at_end()) return;
  reader_done_ = true;
  const bool last_word_waits = room_->wants_close(id_) && !last_word_said_;
  if (!last_word_waits) close();
}

void Session::receive(std::span<const std::byte> bytes) {
  if (plant_ != Plant::kRoomExtendsDeadline || answered_) return room_->receive(id_, bytes);
  said_.insert(said_.end(), bytes.begin(), bytes.end());
  room_->disconnect(id_);
  id_ = room_->connect();
  room_->receive(id_, said_);
}

void Session::write() {
  for (;;) {
    if (written_ < pending_.size()) {
      written_ += wire_->down.write(std::span<const std::byte>(pending_).subspan(written_));
      if (written_ < pending_.size()) return;
    }
    if (!room_->has_output(id_)) break;
    pending_.clear();
    written_ = 0;
    for (const server::Shared& bytes : room_->take_output(id_)) {
      pending_.insert(pending_.end(), bytes->begin(), bytes->end());
    }
    if (pending_.size() > limits_.queue_bytes_max) check_bound(pending_);
    if (plant_ != Plant::kNone) pending_ = tamper_.tampered(pending_);
    if (!answered_) look_at(pending_);
  }
  if (!room_->wants_close(id_) || last_word_said_) return;
  last_word_said_ = true;
  wire_->down.finish();
  if (reader_done_) close();
}

void Session::look_at(const protocol::Bytes& output) {
  answered_ = true;
  protocol::Framer framer(protocol::kServerMessageBytesMax);
  (void)framer.feed(output);
  const auto payload = framer.next();
  if (!payload) return;
  const auto decoded = protocol::decode_server(*payload);
  if (!decoded.message) {
    return chronicle_->violate(Invariant::kHonesty,
                               "the server says what is no message: " + decoded.error);
  }
  if (const auto* refused = std::get_if<protocol::Refused>(&*decoded.message)) {
    chronicle_->count(Event::kRefusal);
    chronicle_->note(name() + " is refused: " + refused->reason);
    return;
  }
  const auto* welcome = std::get_if<protocol::Welcome>(&*decoded.message);
  if (welcome == nullptr) return;
  seat_ = welcome->seat;
  chronicle_->count(Event::kWelcome);
  chronicle_->note(name() + " is welcome at tick " + std::to_string(welcome->tick) + ", seat " +
                   std::to_string(seat_));
  if (wire_->unwelcome) {
    chronicle_->violate(Invariant::kRefusals, name() + " is welcome, which says nothing right");
  }
}

void Session::check_bound(const protocol::Bytes& output) {
  protocol::Framer framer(protocol::kServerMessageBytesMax);
  (void)framer.feed(output);
  std::size_t counted = 0;
  while (const auto payload = framer.next()) {
    const auto decoded = protocol::decode_server(*payload);
    if (decoded.message && !is_state(*decoded.message)) counted += payload->size() + 4;
  }
  if (counted <= limits_.queue_bytes_max + kBeyondBound) return;
  chronicle_->violate(Invariant::kQueues, std::to_string(counted) + " bytes waited for " + name() +
                                              ", of at most " +
                                              std::to_string(limits_.queue_bytes_max));
}

void Session::close() {
  if (closed_) return;
  closed_ = true;
  room_->disconnect(id_);
  // As the kernel: what was not read makes a reset of the end.
  if (wire_->up.held_bytes() != 0) return wire_->reset();
  wire_->down.finish();
}

}  // namespace cycloid::sim
