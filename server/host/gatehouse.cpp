#include "server/host/gatehouse.hpp"

#include <chrono>
#include <utility>

#include "server/host/process_time.hpp"

namespace cycloid::server {
namespace {

constexpr std::chrono::milliseconds kSweep{50};
/// From a refusal to the end: time for the peer to read it and hang up.
constexpr std::int64_t kLingerNs = 1'000'000'000;
/// Who was refused may go on sending; so many of them are heard out at a time.
constexpr std::size_t kCallersLeavingMax = 1024;

}  // namespace

Gatehouse::Gatehouse(Strand strand, std::shared_ptr<HostMeters> meters, GatehouseOptions options)
    : strand_(std::move(strand)),
      meters_(std::move(meters)),
      options_(std::move(options)),
      gate_(options_.gate),
      sweep_timer_(strand_) {}

void Gatehouse::receive(asio::ip::tcp::socket socket) {
  meters_->accepted.add();
  asio::error_code error;
  const auto peer = socket.remote_endpoint(error);
  if (error || shut_) return;  // Gone already.
  socket.non_blocking(true, error);
  set_socket_options(socket, options_.sockets);
  const auto caller = std::make_shared<Caller>(std::move(socket));
  const std::uint64_t open = meters_->connections.get();
  meters_->connections.add();
  caller->count = std::shared_ptr<void>(
      nullptr, [meters = meters_](void*) { meters->connections.add(~std::uint64_t{0}); });
  if (closed_) return see_off(caller, *closed_);
  if (open >= options_.connections_max) {
    return see_off(
        caller, {protocol::Refusal::kRoomFull, std::to_string(open) + " connections, of at most " +
                                                   std::to_string(options_.connections_max)});
  }
  const NewcomerId id = ++last_id_;
  Verdict verdict = gate_.arrive(id, peer.address().to_string(), process_now_ns());
  if (verdict.kind == Verdict::Kind::kRefuse) return see_off(caller, verdict.refused);
  waiting_.emplace(id, caller);
  count_pending();
  wait(id, caller);
  sweep();
}

void Gatehouse::turn_away(asio::ip::tcp::socket socket, const protocol::Refused& refused) {
  const auto caller = std::make_shared<Caller>(std::move(socket));
  see_off(caller, refused);
}

void Gatehouse::turn_away_now(asio::ip::tcp::socket& socket, const protocol::Refused& refused) {
  meters_->refusals[static_cast<std::size_t>(refused.code)].add();
  asio::error_code ignored;  // Whoever cannot be told is not told.
  socket.non_blocking(true, ignored);
  // What lies unread when a socket closes would reset the connection, and our word with it.
  while (socket.read_some(asio::buffer(scratch_), ignored) > 0) {
  }
  const protocol::Bytes word = protocol::encode(protocol::ServerMessage(refused));
  (void)socket.write_some(asio::buffer(word), ignored);
}

void Gatehouse::set_limits(const GateLimits& limits, std::size_t connections_max) {
  gate_.set_limits(limits);
  options_.connections_max = connections_max;
}

void Gatehouse::close() {
  shut_ = true;
  asio::error_code ignored;  // Closed is closed.
  for (auto* callers : {&waiting_, &leaving_}) {
    for (auto& [id, caller] : *callers) caller->socket.close(ignored);
    callers->clear();
  }
  sweep_timer_.cancel();
}

void Gatehouse::wait(NewcomerId id, const CallerPtr& caller) {
  auto handler = [this, id, caller](const asio::error_code& error) {
    if (!error) on_readable(id, caller);
  };
  caller->socket.async_wait(asio::ip::tcp::socket::wait_read,
                            asio::bind_executor(strand_, std::move(handler)));
}

void Gatehouse::on_readable(NewcomerId id, const CallerPtr& caller) {
  if (!waiting_.contains(id)) return;  // Its deadline came first.
  asio::error_code error;
  const std::size_t bytes = caller->socket.read_some(asio::buffer(scratch_), error);
  if (error == asio::error::would_block) return wait(id, caller);
  if (error) {
    gate_.leave(id);
    waiting_.erase(id);
    return count_pending();
  }
  obey(id, caller, gate_.hear(id, std::span<const std::byte>(scratch_).first(bytes)));
}

void Gatehouse::obey(NewcomerId id, const CallerPtr& caller, Verdict verdict) {
  if (verdict.kind == Verdict::Kind::kWait) return wait(id, caller);
  waiting_.erase(id);
  count_pending();
  if (verdict.kind == Verdict::Kind::kRefuse) return see_off(caller, verdict.refused);
  options_.on_admitted(Entrant{std::move(caller->socket), std::move(verdict.admission),
                               std::move(verdict.rest), std::move(caller->count)});
}

void Gatehouse::see_off(const CallerPtr& caller, const protocol::Refused& refused) {
  if (leaving_.size() >= kCallersLeavingMax) return turn_away_now(caller->socket, refused);
  meters_->refusals[static_cast<std::size_t>(refused.code)].add();
  const protocol::Bytes word = protocol::encode(protocol::ServerMessage(refused));
  asio::error_code ignored;
  caller->socket.non_blocking(true, ignored);
  // Nothing was written to this socket before, so the kernel has room for it.
  (void)caller->socket.write_some(asio::buffer(word), ignored);
  caller->socket.shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  caller->until_ns = process_now_ns() + kLingerNs;
  const NewcomerId id = ++last_id_;
  leaving_.emplace(id, caller);
  wait_for_end(id, caller);
  sweep();
}

void Gatehouse::wait_for_end(NewcomerId id, const CallerPtr& caller) {
  auto handler = [this, id, caller](const asio::error_code& error) {
    asio::error_code at_end = error;
    if (!at_end) (void)caller->socket.read_some(asio::buffer(scratch_), at_end);
    if (!at_end || at_end == asio::error::would_block) return wait_for_end(id, caller);
    leaving_.erase(id);
  };
  caller->socket.async_wait(asio::ip::tcp::socket::wait_read,
                            asio::bind_executor(strand_, std::move(handler)));
}

void Gatehouse::sweep() {
  if (std::exchange(sweeping_, true)) return;
  sweep_timer_.expires_after(kSweep);
  sweep_timer_.async_wait([this](const asio::error_code& error) {
    sweeping_ = false;
    if (error || shut_) return;
    const std::int64_t now_ns = process_now_ns();
    for (const auto& [id, refused] : gate_.overdue(now_ns)) {
      const auto found = waiting_.find(id);
      if (found == waiting_.end()) continue;
      const CallerPtr caller = found->second;
      waiting_.erase(found);
      see_off(caller, refused);
    }
    asio::error_code ignored;
    while (!leaving_.empty() && leaving_.begin()->second->until_ns <= now_ns) {
      leaving_.begin()->second->socket.close(ignored);
      leaving_.erase(leaving_.begin());
    }
    count_pending();
    if (!waiting_.empty() || !leaving_.empty()) sweep();
  });
}

void Gatehouse::count_pending() {
  meters_->pending.set(waiting_.size());
}

}  // namespace cycloid::server
