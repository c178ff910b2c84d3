#include "cli/sim/session.hpp"

#include <utility>
#include <variant>

#include "cli/sim/issuer.hpp"

namespace cycloid::sim {
namespace {

constexpr std::int64_t kLinger = kSecond;
/// A last word is not counted, and the message that reaches the bound is.
constexpr std::size_t kBeyondBound = 1024;

bool is_state(const protocol::ServerMessage& message) {
  return std::holds_alternative<protocol::Snapshot>(message) ||
         std::holds_alternative<protocol::SnapshotPart>(message) ||
         std::holds_alternative<protocol::StateDelta>(message);
}

}  // namespace

Session::Session(std::shared_ptr<Wire> wire, const House& house, const server::Limits& limits,
                 Plant plant, Chronicle& chronicle)
    : wire_(std::move(wire)),
      house_(house),
      limits_(limits),
      plant_(plant),
      chronicle_(&chronicle),
      tamper_(plant) {
  enter(wire_->address);
}

void Session::enter(const server::PeerAddress& from) {
  const auto begun = house_.gate->begin(from, chronicle_->now_ns);
  if (const auto* refused = std::get_if<server::GateRefused>(&begun)) return turn_away(*refused);
  gate_id_ = std::get<server::GateId>(begun);
}

void Session::hear_at_gate(std::span<const std::byte> bytes) {
  const std::int64_t now = chronicle_->now_ns;
  const auto result = house_.gate->feed(gate_id_, bytes, {now, unix_s_of(now)});
  if (const auto* refused = std::get_if<server::GateRefused>(&result)) return turn_away(*refused);
  const auto* admitted = std::get_if<server::GateAdmitted>(&result);
  if (admitted == nullptr) return;
  stage_ = Stage::kRoom;
  if (!admitted->admission.identity.empty()) chronicle_->count(Event::kTokenShown);
  id_ = house_.room->admit(admitted->admission);
  if (!admitted->rest.empty()) house_.room->receive(id_, admitted->rest);
}

void Session::turn_away(const server::GateRefused& refused) {
  stage_ = Stage::kTurnedAway;
  pending_ = refused.message;
  written_ = 0;
  look_at(pending_);
}

void Session::step(std::int64_t step_ns) {
  if (closed_) return;
  if (wire_->up.is_reset()) return close();
  read();
  if (!closed_) write();
  if (closed_) return;
  if (is_dismissed() && linger_until_ns_ == kNever) {
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
  while (!reader_done_ && wants_bytes()) {
    const auto bytes = wire_->up.read(kReadBytes);
    if (bytes.empty()) break;
    receive(bytes);
  }
  if (reader_done_ || !wire_->up.at_end()) return;
  reader_done_ = true;
  const bool last_word_waits = is_dismissed() && !last_word_said_;
  if (!last_word_waits) close();
}

void Session::receive(std::span<const std::byte> bytes) {
  if (stage_ == Stage::kRoom) return house_.room->receive(id_, bytes);
  if (stage_ == Stage::kTurnedAway) return;
  if (plant_ != Plant::kRoomExtendsDeadline) return hear_at_gate(bytes);
  said_.insert(said_.end(), bytes.begin(), bytes.end());
  house_.gate->end(gate_id_);
  // Not from its own address, against which every byte would count as a connection.
  enter(server::PeerAddress::v4({127, 0, 0, 1}));
  if (stage_ == Stage::kGate) hear_at_gate(said_);
}

void Session::write() {
  for (;;) {
    if (written_ < pending_.size()) {
      written_ += wire_->down.write(std::span<const std::byte>(pending_).subspan(written_));
      if (written_ < pending_.size()) return;
    }
    if (stage_ != Stage::kRoom || !house_.room->has_output(id_)) break;
    pending_.clear();
    written_ = 0;
    for (const server::Shared& bytes : house_.room->take_output(id_)) {
      pending_.insert(pending_.end(), bytes->begin(), bytes->end());
    }
    if (pending_.size() > limits_.queue_bytes_max) check_bound(pending_);
    if (plant_ != Plant::kNone) pending_ = tamper_.tampered(pending_);
    if (!answered_) look_at(pending_);
  }
  if (!is_dismissed() || last_word_said_) return;
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
  wire_->timeline = house_.ledger->timeline();
  wire_->seat = seat_;
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
  house_.gate->end(gate_id_);
  if (stage_ == Stage::kRoom) house_.room->disconnect(id_);
  // As the kernel: what was not read makes a reset of the end.
  if (wire_->up.held_bytes() != 0) return wire_->reset();
  wire_->down.finish();
}

}  // namespace cycloid::sim
