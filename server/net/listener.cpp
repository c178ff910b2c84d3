#include "server/net/listener.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <system_error>
#include <utility>

#include "server/net/rethrow.hpp"

namespace cycloid::server {
namespace {

/// After a failed accept, which at the limit of descriptors would fail again at once and for ever.
constexpr std::chrono::milliseconds kBackOff{100};
/// So many failures in a row before the reserve is used: a second.
constexpr int kPatienceFailures = 10;
/// Turned away in one go; the next go comes after a back-off.
constexpr int kTurnedAwayMax = 64;

void check(const asio::error_code& error, const std::string& what) {
  if (error) throw std::system_error(error.value(), error.category(), what);
}

bool out_of_descriptors(const asio::error_code& error) {
  return error == asio::error::no_descriptors ||
         error == std::error_condition(std::errc::too_many_files_open_in_system);
}

}  // namespace

Listener::Listener(asio::strand<asio::io_context::executor_type> strand, ListenerOptions options)
    : strand_(std::move(strand)),
      options_(std::move(options)),
      acceptor_(strand_),
      back_off_(strand_) {
  const std::string name = options_.address + ":" + std::to_string(options_.port);
  asio::error_code error;
  const asio::ip::address parsed = asio::ip::make_address(options_.address, error);
  check(error, name);
  const asio::ip::tcp::endpoint endpoint(parsed, options_.port);
  acceptor_.open(endpoint.protocol(), error);
  check(error, name);
  acceptor_.set_option(asio::socket_base::reuse_address(true), error);
  check(error, name);
  acceptor_.bind(endpoint, error);
  check(error, name);
  acceptor_.listen(asio::socket_base::max_listen_connections, error);
  check(error, name);
  acceptor_.non_blocking(true, error);
  check(error, name);
  port_ = acceptor_.local_endpoint().port();
  open_reserve();
}

Listener::~Listener() {
  close_reserve();
}

void Listener::start() {
  auto loop = [this] { return accept_loop(); };
  asio::co_spawn(strand_, std::move(loop), rethrow);
}

void Listener::close() {
  asio::error_code ignored;  // Closed is closed.
  acceptor_.close(ignored);
  back_off_.cancel();
}

void Listener::open_reserve() {
  if (reserve_ < 0) reserve_ = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
}

void Listener::close_reserve() {
  if (reserve_ >= 0) (void)::close(std::exchange(reserve_, -1));
}

void Listener::turn_away() {
  close_reserve();
  for (int i = 0; i < kTurnedAwayMax; ++i) {
    asio::ip::tcp::socket socket(strand_.get_inner_executor());
    asio::error_code error;
    acceptor_.accept(socket, error);  // Does not block.
    if (error) break;
    if (options_.on_crowded) options_.on_crowded(socket);
  }
  open_reserve();
}

asio::awaitable<void> Listener::accept_loop() {
  asio::error_code error;
  auto done = asio::redirect_error(asio::use_awaitable, error);
  while (acceptor_.is_open()) {
    asio::ip::tcp::socket socket(strand_.get_inner_executor());
    co_await acceptor_.async_accept(socket, done);
    if (!acceptor_.is_open()) break;
    if (error) {
      if (options_.on_failure) options_.on_failure();
      const std::string why = error.message();
      if (!std::exchange(trouble_told_, true)) options_.trouble(why);
      if (++failures_ >= kPatienceFailures && out_of_descriptors(error)) turn_away();
      back_off_.expires_after(kBackOff);
      co_await back_off_.async_wait(done);
      continue;
    }
    failures_ = 0;
    options_.on_connection(std::move(socket));
  }
}

}  // namespace cycloid::server
