#include "server/host/gatehouse.hpp"

#include <chrono>
#include <utility>

#include "server/host/process_time.hpp"
#include "server/net/rethrow.hpp"

namespace cycloid::server {

// GCC 12.2 destroys aggregate temporaries of a co_await expression twice: named locals only.

namespace {

constexpr std::chrono::milliseconds kSweep{50};
/// From a refusal to the end: time for the peer to read it and hang up.
constexpr std::int64_t kFarewellNs = 1'000'000'000;
/// Who was refused may go on sending; so many of them are heard out at a time.
constexpr std::size_t kCallersLeavingMax = 1024;
/// Of what was sent by one who is turned away at once: whoever sends as fast as it is read may be
/// reset.
constexpr int kReadsMax = 16;
/// Enough for a hello, whose connection then goes elsewhere.
constexpr std::size_t kTlsReadBytes = 2048;

PeerAddress address_of(const asio::ip::address& address) {
  if (address.is_v4()) return PeerAddress::v4(address.to_v4().to_bytes());
  return PeerAddress::v6(address.to_v6().to_bytes());
}

/// No address where the peer has gone already.
PeerAddress address_of(const asio::ip::tcp::socket& socket) {
  asio::error_code error;
  const auto peer = socket.remote_endpoint(error);
  return error ? PeerAddress() : address_of(peer.address());
}

GateTime gate_time() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return {process_now_ns(), std::chrono::duration_cast<std::chrono::seconds>(since_epoch).count()};
}

GateRefused encoded_refusal(const protocol::Refused& refused) {
  return {refused.code, refused.reason, protocol::encode(protocol::ServerMessage(refused))};
}

}  // namespace

Gatehouse::Gatehouse(Strand strand, std::shared_ptr<HostMeters> meters, GatehouseOptions options)
    : strand_(std::move(strand)),
      meters_(std::move(meters)),
      options_(std::move(options)),
      gate_(options_.gate, options_.find_room),
      sweep_timer_(strand_) {}

std::shared_ptr<void> Gatehouse::counted(GateId id) {
  meters_->connections.add();
  return {nullptr, [id, closed = closed_, meters = meters_](void*) {
            meters->connections.add(~std::uint64_t{0});
            const std::lock_guard lock(closed->mutex);
            closed->ids.push_back(id);
          }};
}

void Gatehouse::forget_closed() {
  std::vector<GateId> ids;
  {
    const std::lock_guard lock(closed_->mutex);
    ids.swap(closed_->ids);
  }
  for (const GateId id : ids) gate_.end(id);
}

void Gatehouse::receive(asio::ip::tcp::socket socket) {
  meters_->accepted.add();
  forget_closed();
  asio::error_code error;
  const auto peer = socket.remote_endpoint(error);
  if (error || shut_) return;  // Gone already.
  socket.non_blocking(true, error);
  set_socket_options(socket, options_.sockets);
  const auto caller = std::make_shared<Caller>();
  caller->address = address_of(peer.address());
  const auto begun = gate_.begin(caller->address, process_now_ns());
  if (const auto* refused = std::get_if<GateRefused>(&begun)) {
    note(caller->address, refused->code, refused->reason);
    return say_and_close(socket, {refused->code, refused->reason});
  }
  const GateId id = std::get<GateId>(begun);
  caller->count = counted(id);
  caller->stream = std::make_unique<transport::Stream>(
      std::move(socket), options_.tls == nullptr ? nullptr : options_.tls->current());
  waiting_.emplace(id, caller);
  meters_->pending.set(waiting_.size());
  if (caller->stream->is_tls()) {
    auto talk = [this, id, caller] { return receive_tls(id, caller); };
    asio::co_spawn(strand_, std::move(talk), rethrow);
  } else {
    caller->can_be_told = true;
    wait(id, caller);
  }
  sweep();
}

asio::awaitable<void> Gatehouse::receive_tls(GateId id, CallerPtr caller) {
  // The gate counts from the connection on; this bounds the handshake by the same time.
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::nanoseconds(options_.gate.hello_deadline_ns);
  const Handshake shaken = co_await shake_hands(*caller->stream, deadline);
  if (!waiting_.contains(id)) co_return;  // Its deadline came first.
  if (shaken.end == Handshake::End::kPlaintext) {
    lose(id);
    const protocol::Refused refused{protocol::Refusal::kBadMessage, shaken.reason};
    note(caller->address, refused.code, refused.reason);
    say_and_close(caller->stream->socket(), refused);
    co_return;
  }
  if (shaken.end != Handshake::End::kDone) {
    lose(id);
    co_return;
  }
  caller->can_be_told = true;
  asio::error_code error;
  auto done = asio::redirect_error(asio::use_awaitable, error);
  std::array<std::byte, kTlsReadBytes> incoming;
  const auto target = asio::buffer(incoming);
  for (;;) {
    const std::size_t bytes = co_await caller->stream->async_read_some(target, done);
    if (!waiting_.contains(id)) co_return;
    if (error) {
      lose(id);
      co_return;
    }
    if (!hear(id, caller, std::span<const std::byte>(incoming).first(bytes))) co_return;
  }
}

void Gatehouse::lose(GateId id) {
  waiting_.erase(id);
  meters_->pending.set(waiting_.size());
}

void Gatehouse::wait(GateId id, const CallerPtr& caller) {
  auto handler = [this, id, caller](const asio::error_code& error) {
    if (!error) on_readable(id, caller);
  };
  caller->stream->socket().async_wait(asio::ip::tcp::socket::wait_read,
                                      asio::bind_executor(strand_, std::move(handler)));
}

void Gatehouse::on_readable(GateId id, const CallerPtr& caller) {
  if (!waiting_.contains(id)) return;  // Its deadline came first.
  asio::error_code error;
  const std::size_t bytes = caller->stream->socket().read_some(asio::buffer(scratch_), error);
  if (error == asio::error::would_block) return wait(id, caller);
  if (error) return lose(id);
  if (hear(id, caller, std::span<const std::byte>(scratch_).first(bytes))) wait(id, caller);
}

bool Gatehouse::hear(GateId id, const CallerPtr& caller, std::span<const std::byte> bytes) {
  meters_->gate_bytes.add(bytes.size());
  GateResult result = gate_.feed(id, bytes, gate_time());
  if (std::holds_alternative<GateWaiting>(result)) return true;
  lose(id);
  if (auto* refused = std::get_if<GateRefused>(&result)) {
    note(caller->address, refused->code, refused->reason);
    see_off(caller, std::move(*refused));
    return false;
  }
  auto& admitted = std::get<GateAdmitted>(result);
  options_.on_admitted(Entrant{std::move(caller->stream), std::move(admitted.admission),
                               std::move(admitted.rest), std::move(caller->count)});
  return false;
}

void Gatehouse::note(const PeerAddress& address, protocol::Refusal code,
                     const std::string& reason) {
  meters_->refusals[static_cast<std::size_t>(code)].add();
  const RefusalLog::Line line = refusal_log_.note(code, address, process_now_ns());
  if (!line.write) return;
  options_.logger->warn(refusal_line(code, reason, address, line.suppressed));
}

void Gatehouse::turn_away(Entrant entrant, const protocol::Refused& refused) {
  gate_.give_back_token(entrant.admission);
  const auto caller = std::make_shared<Caller>();
  caller->stream = std::move(entrant.stream);
  caller->count = std::move(entrant.count);
  caller->address = address_of(caller->stream->socket());
  GateRefused word = encoded_refusal(refused);
  note(caller->address, refused.code, refused.reason);
  see_off(caller, std::move(word));
}

void Gatehouse::turn_away_now(asio::ip::tcp::socket& socket, const protocol::Refused& refused) {
  note(address_of(socket), refused.code, refused.reason);
  say_and_close(socket, refused);
}

void Gatehouse::say_and_close(asio::ip::tcp::socket& socket, const protocol::Refused& refused) {
  asio::error_code ignored;  // Whoever cannot be told is not told.
  socket.non_blocking(true, ignored);
  // What lies unread when a socket closes would reset the connection, and our word with it.
  for (int i = 0; i < kReadsMax && socket.read_some(asio::buffer(scratch_), ignored) > 0; ++i) {
  }
  const protocol::Bytes word = protocol::encode(protocol::ServerMessage(refused));
  (void)socket.write_some(asio::buffer(word), ignored);
  socket.close(ignored);
}

void Gatehouse::see_off(const CallerPtr& caller, GateRefused refused) {
  if (leaving_.size() >= kCallersLeavingMax || shut_) return;
  caller->until_ns = process_now_ns() + kFarewellNs;
  const std::uint64_t leaver = ++leavers_;
  leaving_.emplace(leaver, caller);
  const auto word = std::make_shared<const protocol::Bytes>(std::move(refused.message));
  auto written = [this, leaver, caller, word](const asio::error_code& error, std::size_t) {
    if (error) return wait_for_end(leaver, caller);
    say_no_more(leaver, caller);
  };
  asio::async_write(*caller->stream, asio::buffer(*word),
                    asio::bind_executor(strand_, std::move(written)));
  sweep();
}

void Gatehouse::say_no_more(std::uint64_t leaver, const CallerPtr& caller) {
  auto said = [this, leaver, caller](const asio::error_code&) {
    asio::error_code ignored;
    caller->stream->socket().shutdown(asio::socket_base::shutdown_send, ignored);
    wait_for_end(leaver, caller);
  };
  caller->stream->async_shutdown(asio::bind_executor(strand_, std::move(said)));
}

void Gatehouse::wait_for_end(std::uint64_t leaver, const CallerPtr& caller) {
  // Of one through TLS too only the bytes count: nobody reads them.
  auto handler = [this, leaver, caller](const asio::error_code& error) {
    asio::error_code at_end = error;
    asio::ip::tcp::socket& socket = caller->stream->socket();
    if (!at_end) (void)socket.read_some(asio::buffer(scratch_), at_end);
    if (!at_end || at_end == asio::error::would_block) return wait_for_end(leaver, caller);
    leaving_.erase(leaver);
  };
  caller->stream->socket().async_wait(asio::ip::tcp::socket::wait_read,
                                      asio::bind_executor(strand_, std::move(handler)));
}

void Gatehouse::sweep() {
  if (std::exchange(sweeping_, true)) return;
  sweep_timer_.expires_after(kSweep);
  sweep_timer_.async_wait([this](const asio::error_code& error) {
    sweeping_ = false;
    if (error || shut_) return;
    const std::int64_t now_ns = process_now_ns();
    for (GateOverdue& overdue : gate_.overdue(now_ns)) {
      const auto found = waiting_.find(overdue.id);
      if (found == waiting_.end()) continue;
      const CallerPtr caller = found->second;
      lose(overdue.id);
      note(caller->address, overdue.refused.code, overdue.refused.reason);
      if (caller->can_be_told) {
        see_off(caller, std::move(overdue.refused));
      } else {
        caller->stream->close();
      }
    }
    while (!leaving_.empty() && leaving_.begin()->second->until_ns <= now_ns) {
      leaving_.begin()->second->stream->close();
      leaving_.erase(leaving_.begin());
    }
    forget_closed();
    if (!waiting_.empty() || !leaving_.empty()) sweep();
  });
}

void Gatehouse::close() {
  shut_ = true;
  for (auto& [id, caller] : waiting_) caller->stream->close();
  for (auto& [leaver, caller] : leaving_) caller->stream->close();
  waiting_.clear();
  leaving_.clear();
  sweep_timer_.cancel();
}

}  // namespace cycloid::server
