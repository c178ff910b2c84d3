#include <gtest/gtest.h>

#include "client/net/connection.hpp"
#include "tests/server/tls_fixture.hpp"

namespace cycloid::server {
namespace {

/// A client's connection, and what it was told.
class TlsConnection : public TlsPeers {
 protected:
  void open(const client::TlsTrust& trust, const std::string& host = "127.0.0.1") {
    client::Connection::Limits limits;
    limits.connect = std::chrono::milliseconds(1500);
    client::Connection::Handlers handlers;
    handlers.on_open = [this] { connection_->send(protocol::Hello{}); };
    handlers.on_message = [this](const protocol::ServerMessage& message) {
      const auto* refused = std::get_if<protocol::Refused>(&message);
      if (refused != nullptr) heard_ = refused->reason;
      connection_->finish("done");
    };
    handlers.on_poll = [] {};
    handlers.on_closed = [this](const std::string& reason) { closed_.push_back(reason); };
    connection_ = std::make_unique<client::Connection>(
        io_, limits, std::move(handlers), std::make_shared<const client::ClientTls>(trust));
    connection_->open(host, acceptor_.local_endpoint().port());
  }

  /// Reads a hello and says one word, then waits for the end.
  awaitable<void> answer(Stream::Context context, Handshake& shaken) {
    Tcp::socket socket = co_await acceptor_.async_accept(asio::use_awaitable);
    Stream stream(std::move(socket), std::move(context));
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    shaken = co_await shake_hands(stream, deadline);
    if (shaken.end != Handshake::End::kDone) co_return;
    std::vector<std::byte> bytes(1024);
    const auto target = asio::buffer(bytes);
    const std::size_t count = co_await stream.async_read_some(target, asio::use_awaitable);
    EXPECT_GT(count, 8u);
    const protocol::Refused refused{protocol::Refusal::kDraining, "through TLS"};
    const protocol::Bytes word = protocol::encode(protocol::ServerMessage(refused));
    const auto out = asio::buffer(word);
    co_await asio::async_write(stream, out, asio::use_awaitable);
    co_await echo_to_the_end(stream);
  }

  std::unique_ptr<client::Connection> connection_;
  std::string heard_;
  std::vector<std::string> closed_;
};

TEST_F(TlsConnection, TalksToATrustedServer) {
  const ServerTls server(files());
  Handshake shaken;
  spawn([&] { return answer(server.current(), shaken); });
  open(trust());
  run();
  EXPECT_EQ(shaken.end, Handshake::End::kDone) << shaken.reason;
  EXPECT_EQ(heard_, "through TLS");
  EXPECT_EQ(closed_, std::vector<std::string>{"done"});
}

TEST_F(TlsConnection, SaysNothingToAnotherServer) {
  const ServerTls server(files());
  write_certificate(file("other.pem"), make_identity({"other", "", -3600, 3600}));
  Handshake shaken;
  spawn([&] { return answer(server.current(), shaken); });
  open({file("other.pem"), ""});
  run();
  EXPECT_EQ(shaken.end, Handshake::End::kFailed);
  ASSERT_EQ(closed_.size(), 1u);
  EXPECT_EQ(closed_[0],
            "the server's certificate is refused: unable to get local issuer certificate");
}

/// An empty host is the loopback to the resolver, and to OpenSSL the wish to check no name.
TEST_F(TlsConnection, DoesNotBeginWithoutANameToVerify) {
  const ServerTls server(files());
  Handshake shaken;
  spawn([&] { return answer(server.current(), shaken); });
  open(trust(), "");
  run();
  EXPECT_NE(shaken.end, Handshake::End::kDone);
  EXPECT_EQ(heard_, "");
  EXPECT_EQ(closed_, std::vector<std::string>{"no name to verify the server by"});
}

TEST_F(TlsConnection, GivesUpOnAServerThatDoesNotSpeakTls) {
  for (const bool answers : {true, false}) {
    SCOPED_TRACE(answers);
    closed_.clear();
    spawn([&]() -> awaitable<void> {
      Tcp::socket socket = co_await acceptor_.async_accept(asio::use_awaitable);
      const std::vector<std::byte> word = tls_required_message();
      const auto out = asio::buffer(word);
      if (answers) co_await asio::async_write(socket, out, asio::use_awaitable);
      std::vector<std::byte> bytes(4096);
      const auto target = asio::buffer(bytes);
      asio::error_code error;
      auto done = asio::redirect_error(asio::use_awaitable, error);
      while (!error) co_await socket.async_read_some(target, done);
    });
    open(trust());
    run();
    ASSERT_EQ(closed_.size(), 1u);
    EXPECT_EQ(closed_[0], answers ? "no TLS handshake: wrong version number (SSL routines); does "
                                    "the server speak TLS here?"
                                  : "no connection in time");
  }
}

}  // namespace
}  // namespace cycloid::server
