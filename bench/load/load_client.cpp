#include "bench/load/load_client.hpp"

#include <poll.h>

#include <variant>

namespace cycloid::load {
namespace {

double ms_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

}  // namespace

void ClientTally::begin_measuring() {
  frames = snapshots = gaps = bytes_in = update_bytes = 0;
  frame_gap_ms.clear();
  input_to_state_ms.clear();
}

LoadClient::LoadClient(asio::io_context& io, const ClientPlan& plan, ClientTally& tally)
    : plan_(plan), tally_(tally), socket_(io), timer_(io) {
  protocol::Hello hello;
  hello.scene_digest = plan.scene_digest;
  hello.mode = plan.mode;
  hello.profile = plan.profile;
  hello.room = plan.room;
  hello.seat_wish = plan.behaviour == Behaviour::kPlays ? protocol::kAnySeat : protocol::kSpectator;
  hello.name = "load";
  hello_ = protocol::encode(protocol::ClientMessage(hello));
}

void LoadClient::start() {
  const asio::ip::tcp::endpoint server(asio::ip::make_address(plan_.address), plan_.port);
  auto connected = [self = shared_from_this()](const asio::error_code& error) {
    if (error) return self->end();
    asio::error_code ignored;
    self->socket_.set_option(asio::ip::tcp::no_delay(true), ignored);
    self->opened_ = self->updated_ = Clock::now();
    self->greet();
  };
  socket_.async_connect(server, std::move(connected));
}

void LoadClient::stop() {
  ended_ = true;
  asio::error_code ignored;
  timer_.cancel();
  socket_.close(ignored);
}

void LoadClient::greet() {
  if (plan_.behaviour == Behaviour::kDrips) {
    drip();
  } else if (plan_.behaviour != Behaviour::kIdles) {
    queue_.push_back(hello_);
    write();
  }
  read();
}

void LoadClient::drip() {
  if (dripped_ == hello_.size() || !socket_.is_open()) return;
  queue_.push_back({hello_[dripped_++]});
  write();
  timer_.expires_after(std::chrono::seconds(1));
  timer_.async_wait([self = shared_from_this()](const asio::error_code& error) {
    if (!error) self->drip();
  });
}

void LoadClient::read() {
  auto arrived = [self = shared_from_this()](const asio::error_code& error, std::size_t bytes) {
    if (error) return self->end();
    self->take(bytes);
    if (self->silent_) return self->watch_for_the_end();
    if (self->socket_.is_open()) self->read();
  };
  socket_.async_read_some(asio::buffer(incoming_), std::move(arrived));
}

/// That the server has hung up shows without a read.
void LoadClient::watch_for_the_end() {
  if (ended_) return;
  pollfd server{socket_.native_handle(), POLLRDHUP, 0};
  if (::poll(&server, 1, 0) > 0) return end();
  timer_.expires_after(std::chrono::seconds(1));
  timer_.async_wait([self = shared_from_this()](const asio::error_code& error) {
    if (!error) self->watch_for_the_end();
  });
}

void LoadClient::take(std::size_t bytes) {
  tally_.bytes_in += bytes;
  if (!framer_.feed(std::span<const std::byte>(incoming_).first(bytes))) return end();
  while (const auto payload = framer_.next()) {
    const auto decoded = protocol::decode_server(*payload);
    if (!decoded.message) return end();
    on_message(*decoded.message, payload->size() + protocol::Framer::kPrefixBytes);
  }
}

void LoadClient::on_message(const protocol::ServerMessage& message, std::size_t bytes) {
  if (const auto* welcome = std::get_if<protocol::Welcome>(&message)) {
    ++tally_.joined;
    seat_ = welcome->seat;
    delay_ticks_ = welcome->input_delay_ticks;
    silent_ = plan_.behaviour == Behaviour::kMute;
  } else if (const auto* refused = std::get_if<protocol::Refused>(&message)) {
    ++tally_.refused;
    tally_.last_refusal = refused->reason;
  } else if (const auto* frame = std::get_if<protocol::InputFrame>(&message)) {
    tally_.update_bytes += bytes;
    on_frame(*frame);
  } else if (const auto* part = std::get_if<protocol::SnapshotPart>(&message)) {
    if (part->offset + part->bytes.size() == part->total_bytes) on_state(part->tick);
  } else if (const auto* snapshot = std::get_if<protocol::Snapshot>(&message)) {
    on_state(snapshot->tick);
  } else if (const auto* delta = std::get_if<protocol::StateDelta>(&message)) {
    tally_.update_bytes += bytes;
    send(protocol::Ack{delta->tick});
    on_state(delta->tick);
  }
}

void LoadClient::on_frame(const protocol::InputFrame& frame) {
  ++tally_.frames;
  if (last_tick_ != 0 && frame.tick != last_tick_ + 1) ++tally_.gaps;
  const auto now = Clock::now();
  tally_.frame_gap_ms.add(ms_between(updated_, now));
  updated_ = now;
  last_tick_ = frame.tick;
  if (seat_ < 0 || plan_.behaviour != Behaviour::kPlays) return;
  const auto& mine = frame.seats[static_cast<std::size_t>(seat_)];
  const bool taken = mine.origin == protocol::Origin::kGiven;
  while (!said_.empty() && said_.front().first <= frame.tick) {
    if (taken && said_.front().first == frame.tick) {
      tally_.input_to_state_ms.add(ms_between(said_.front().second, now));
    }
    said_.pop_front();
  }
  say_input(frame.tick + delay_ticks_);
}

void LoadClient::on_state(std::uint64_t tick) {
  const auto now = Clock::now();
  if (!has_state_) tally_.join_ms.add(ms_between(opened_, now));
  has_state_ = true;
  if (plan_.mode == protocol::Mode::kLockstep) {
    if (last_tick_ < tick) last_tick_ = tick;
    return;
  }
  ++tally_.snapshots;
  tally_.frame_gap_ms.add(ms_between(updated_, now));
  updated_ = now;
  while (!said_.empty() && said_.front().first <= tick) {
    tally_.input_to_state_ms.add(ms_between(said_.front().second, now));
    said_.pop_front();
  }
  if (seat_ < 0 || plan_.behaviour != Behaviour::kPlays) return;
  // Somewhere within the next tick, as people do: the seats spread over it, and so do the ticks.
  const std::uint64_t scatter = (tick * 7 + static_cast<std::uint64_t>(seat_) * 5) % 14;
  timer_.expires_after(std::chrono::milliseconds(scatter));
  timer_.async_wait([self = shared_from_this(), tick](const asio::error_code& error) {
    if (!error) self->say_input(tick + 1);
  });
}

void LoadClient::say_input(std::uint64_t tick) {
  scenes::SeatInput input;
  const bool right = (tick / 60 + static_cast<std::uint64_t>(seat_)) % 2 == 0;
  input.axes[0] = right ? std::int16_t{20000} : std::int16_t{-20000};
  input.buttons = tick % 75 < 4 ? 1 : 0;
  send(protocol::Input{tick, input});
  said_.emplace_back(tick, Clock::now());
}

void LoadClient::send(const protocol::ClientMessage& message) {
  if (!socket_.is_open()) return;
  queue_.push_back(protocol::encode(message));
  write();
}

void LoadClient::write() {
  if (writing_ || queue_.empty()) return;
  writing_ = true;
  auto written = [self = shared_from_this()](const asio::error_code& error, std::size_t) {
    self->writing_ = false;
    if (error) return self->end();
    self->queue_.pop_front();
    self->write();
  };
  asio::async_write(socket_, asio::buffer(queue_.front()), std::move(written));
}

void LoadClient::end() {
  if (ended_) return;
  ++tally_.closed;
  stop();
}

}  // namespace cycloid::load
