#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <asio.hpp>
#include <chrono>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/net/tls.hpp"
#include "server/net/tls.hpp"
#include "tests/server/certificates.hpp"

namespace cycloid::server {

// GCC 12.2 destroys aggregate temporaries of a co_await expression twice: named locals only.

using transport::Stream;
using Tcp = asio::ip::tcp;
using asio::awaitable;

/// Certificates in a folder of their own, and a server on loopback that uses them.
class TlsPeers : public testing::Test {
 protected:
  TlsPeers() {
    std::string pattern = (std::filesystem::temp_directory_path() / "cycloid-tls-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    authority_ = make_identity({"authority", "", -3600, 3600});
    write_certificate(file("ca.pem"), authority_);
    install({});
  }
  ~TlsPeers() override { std::filesystem::remove_all(folder_); }

  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  TlsFiles files() const { return {file("server.pem"), file("server.key")}; }

  /// A new certificate of the authority where the server reads its own.
  Identity install(const CertificateWish& wish) {
    Identity identity = make_identity(wish, &authority_);
    write_certificate(files().certificate_chain, identity);
    write_key(files().private_key, identity);
    return identity;
  }

  client::TlsTrust trust() const { return {file("ca.pem"), ""}; }

  /// Runs until all coroutines have ended, 20 s at most.
  void run() {
    io_.restart();
    io_.run_for(std::chrono::seconds(20));
    EXPECT_TRUE(io_.stopped()) << "a coroutine has not ended";
    if (failure_ != nullptr) std::rethrow_exception(std::exchange(failure_, nullptr));
  }
  void spawn(std::function<awaitable<void>()> coroutine) {
    kept_.push_back(std::make_unique<std::function<awaitable<void>()>>(std::move(coroutine)));
    asio::co_spawn(io_, *kept_.back(), [this](std::exception_ptr failure) {
      if (failure != nullptr) failure_ = failure;
    });
  }

  /// Accepts one connection, shakes hands, and sends back what comes, to the end.
  awaitable<void> echo(Stream::Context context, Handshake& shaken) {
    Tcp::socket socket = co_await acceptor_.async_accept(asio::use_awaitable);
    Stream stream(std::move(socket), std::move(context));
    const auto deadline = std::chrono::steady_clock::now() + handshake_time_;
    shaken = co_await shake_hands(stream, deadline);
    if (shaken.end == Handshake::End::kPlaintext) {
      const std::vector<std::byte> said = tls_required_message();
      const auto message = asio::buffer(said);
      co_await asio::async_write(stream.socket(), message, asio::use_awaitable);
    }
    if (shaken.end != Handshake::End::kDone) co_return;
    co_await echo_to_the_end(stream);
  }

  awaitable<void> echo_to_the_end(Stream& stream) {
    std::vector<std::byte> bytes(16384);
    asio::error_code error;
    auto done = asio::redirect_error(asio::use_awaitable, error);
    const auto target = asio::buffer(bytes);
    for (;;) {
      const std::size_t count = co_await stream.async_read_some(target, done);
      if (error) break;
      const auto back = asio::buffer(bytes.data(), count);
      co_await asio::async_write(stream, back, done);
      if (error) break;
    }
    EXPECT_TRUE(transport::is_end(error)) << error.message();
    co_await stream.async_shutdown(done);
  }

  awaitable<Tcp::socket> connected() {
    Tcp::socket socket(io_);
    const Tcp::endpoint endpoint = acceptor_.local_endpoint();
    co_await socket.async_connect(endpoint, asio::use_awaitable);
    co_return socket;
  }

  /// "" or why the client does not go on.
  awaitable<std::string> greet(Stream& stream, const client::ClientTls& tls, std::string host) {
    const std::string nameless = "no name to verify";
    if (!tls.prepare(stream, host)) co_return nameless;
    asio::error_code error;
    auto done = asio::redirect_error(asio::use_awaitable, error);
    co_await stream.async_handshake(asio::ssl::stream_base::client, done);
    if (!error) co_return std::string();
    const std::string why = tls.reason(stream, error);
    co_return why;
  }

  /// Writes so many bytes while it reads what comes back, then hangs up and reads to the end.
  awaitable<void> exchange(Stream& stream, std::size_t count) {
    std::vector<std::byte> sent(count);
    for (std::size_t i = 0; i < count; ++i) sent[i] = static_cast<std::byte>(i * 7);
    std::vector<std::byte> received(count);
    const auto out = asio::buffer(sent);
    const auto in = asio::buffer(received);
    asio::async_write(stream, out, [](const asio::error_code& error, std::size_t) {
      EXPECT_FALSE(error) << error.message();
    });
    co_await asio::async_read(stream, in, asio::use_awaitable);
    EXPECT_EQ(received, sent);
  }

  awaitable<void> hang_up(Stream& stream) {
    asio::error_code error;
    auto done = asio::redirect_error(asio::use_awaitable, error);
    co_await stream.async_shutdown(done);
    EXPECT_TRUE(!error || transport::is_end(error)) << error.message();
    std::vector<std::byte> more(1);
    const auto target = asio::buffer(more);
    co_await stream.async_read_some(target, done);
    EXPECT_TRUE(transport::is_end(error)) << error.message();
    stream.close();
  }

  /// One client that trusts so and connects to `host`; "" where the handshake was done.
  std::string outcome_of(const client::TlsTrust& trust, const std::string& host = "127.0.0.1") {
    const ServerTls server(files());
    const client::ClientTls tls(trust);
    Handshake shaken;
    std::string why = "never answered";
    spawn([&] { return echo(server.current(), shaken); });
    spawn([&]() -> awaitable<void> {
      Tcp::socket socket = co_await connected();
      Stream stream(std::move(socket), tls.context());
      why = co_await greet(stream, tls, host);
      if (why.empty()) co_await exchange(stream, 1000);
      if (why.empty()) co_await hang_up(stream);
    });
    run();
    EXPECT_EQ(shaken.end == Handshake::End::kDone, why.empty()) << why;
    return why;
  }

  asio::io_context io_;
  Tcp::acceptor acceptor_{io_, Tcp::endpoint(asio::ip::address_v4::loopback(), 0)};
  std::chrono::milliseconds handshake_time_{5000};

 private:
  std::filesystem::path folder_;
  Identity authority_;
  std::exception_ptr failure_;
  std::vector<std::unique_ptr<std::function<awaitable<void>()>>> kept_;
};

}  // namespace cycloid::server
