#include "server/net/listener.hpp"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "server/net/rethrow.hpp"

namespace cycloid::server {
namespace {

/// After a failed accept, which at the limit of descriptors would fail again at once and for ever.
constexpr std::chrono::milliseconds kBackOff{100};

void check(const asio::error_code& error, const std::string& what) {
  if (error) throw std::system_error(error.value(), error.category(), what);
}

}  // namespace

Listener::Listener(asio::io_context& io, const std::string& address, std::uint16_t port,
                   std::size_t sessions_max, std::function<void(const std::string&)> trouble)
    : acceptor_(io), back_off_(io), sessions_max_(sessions_max), trouble_(std::move(trouble)) {
  const std::string name = address + ":" + std::to_string(port);
  asio::error_code error;
  const asio::ip::address parsed = asio::ip::make_address(address, error);
  check(error, name);
  const asio::ip::tcp::endpoint endpoint(parsed, port);
  acceptor_.open(endpoint.protocol(), error);
  check(error, name);
  acceptor_.set_option(asio::socket_base::reuse_address(true), error);
  check(error, name);
  acceptor_.bind(endpoint, error);
  check(error, name);
  acceptor_.listen(asio::socket_base::max_listen_connections, error);
  check(error, name);
}

void Listener::start(Room& room) {
  auto loop = [this, &room] { return accept_loop(room); };
  asio::co_spawn(acceptor_.get_executor(), std::move(loop), rethrow);
}

void Listener::wake_all() {
  std::erase_if(sessions_, [](const auto& session) { return session.expired(); });
  for (const auto& weak : sessions_) {
    if (const auto session = weak.lock()) session->wake();
  }
}

void Listener::close() {
  asio::error_code ignored;  // Closed is closed.
  acceptor_.close(ignored);
  back_off_.cancel();
}

bool Listener::busy() const {
  return std::ranges::any_of(sessions_, [](const auto& session) { return !session.expired(); });
}

asio::awaitable<void> Listener::accept_loop(Room& room) {
  asio::error_code error;
  auto done = asio::redirect_error(asio::use_awaitable, error);
  while (acceptor_.is_open()) {
    asio::ip::tcp::socket socket(acceptor_.get_executor());
    co_await acceptor_.async_accept(socket, done);
    if (!acceptor_.is_open()) break;
    if (error) {
      const std::string why = error.message();
      if (!std::exchange(trouble_told_, true)) trouble_(why);
      back_off_.expires_after(kBackOff);
      co_await back_off_.async_wait(done);
      continue;
    }
    std::erase_if(sessions_, [](const auto& session) { return session.expired(); });
    if (sessions_.size() >= sessions_max_) continue;  // No word either: words cost, too.
    const auto session = std::make_shared<Session>(std::move(socket), room);
    sessions_.push_back(session);
    session->start();
  }
}

}  // namespace cycloid::server
