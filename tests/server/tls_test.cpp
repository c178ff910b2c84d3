#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "protocol/codec.hpp"
#include "protocol/transport/fingerprint.hpp"
#include "tests/server/tls_fixture.hpp"

namespace cycloid::server {
namespace {

using testing::HasSubstr;

TEST_F(TlsPeers, OneTextSpeaksThroughTlsAndOverTcpAlone) {
  const ServerTls server(files());
  const client::ClientTls tls(trust());
  constexpr std::size_t kBytes = 3'000'000;
  for (const bool through_tls : {true, false}) {
    SCOPED_TRACE(through_tls);
    Handshake shaken;
    bool ended = false;
    spawn([&] { return echo(through_tls ? server.current() : nullptr, shaken); });
    spawn([&]() -> awaitable<void> {
      Tcp::socket socket = co_await connected();
      Stream stream(std::move(socket), through_tls ? tls.context() : nullptr);
      EXPECT_EQ(stream.is_tls(), through_tls);
      if (through_tls) {
        const std::string why = co_await greet(stream, tls, "localhost");
        EXPECT_EQ(why, "");
        EXPECT_GE(SSL_version(stream.tls()->native_handle()), TLS1_2_VERSION);
      }
      co_await exchange(stream, kBytes);
      co_await hang_up(stream);
      ended = true;
    });
    run();
    EXPECT_TRUE(ended);
    EXPECT_EQ(shaken.end, Handshake::End::kDone) << shaken.reason;
  }
}

TEST_F(TlsPeers, AClientWithoutTlsIsToldSoInItsOwnWords) {
  const ServerTls server(files());
  Handshake shaken;
  std::vector<std::byte> heard;
  spawn([&] { return echo(server.current(), shaken); });
  spawn([&]() -> awaitable<void> {
    Tcp::socket socket = co_await connected();
    const protocol::Bytes hello = protocol::encode(protocol::ClientMessage(protocol::Hello{}));
    const auto out = asio::buffer(hello);
    co_await asio::async_write(socket, out, asio::use_awaitable);
    asio::error_code error;
    auto done = asio::redirect_error(asio::use_awaitable, error);
    auto in = asio::dynamic_buffer(heard);
    co_await asio::async_read(socket, in, done);
  });
  run();
  EXPECT_EQ(shaken.end, Handshake::End::kPlaintext);
  ASSERT_GT(heard.size(), 4u);
  const auto decoded = protocol::decode_server(std::span(heard).subspan(4));
  ASSERT_TRUE(decoded.message.has_value()) << decoded.error;
  EXPECT_EQ(std::get<protocol::Refused>(*decoded.message).reason, "this server speaks TLS only");
}

TEST_F(TlsPeers, TheClientRefusesAnUnknownAuthority) {
  write_certificate(file("other.pem"), make_identity({"other", "", -3600, 3600}));
  EXPECT_THAT(outcome_of({file("other.pem"), ""}),
              HasSubstr("the server's certificate is refused: unable to get local issuer"));
  EXPECT_EQ(outcome_of(trust()), "");
}

TEST_F(TlsPeers, TheClientRefusesAnExpiredCertificate) {
  install({"old", "IP:127.0.0.1", -7200, -3600});
  EXPECT_EQ(outcome_of(trust()), "the server's certificate is refused: certificate has expired");
  const ServerTls server(files());
  const std::int64_t ended_s = std::time(nullptr) - server.expires_unix_s();
  EXPECT_NEAR(static_cast<double>(ended_s), 3600.0, 60.0);
  install({"early", "IP:127.0.0.1", 3600, 7200});
  EXPECT_EQ(outcome_of(trust()),
            "the server's certificate is refused: certificate is not yet valid");
}

TEST_F(TlsPeers, TheClientRefusesAnotherName) {
  EXPECT_EQ(outcome_of(trust(), "localhost"), "");
  EXPECT_EQ(outcome_of(trust(), "game.example"),
            "the server's certificate is refused: hostname mismatch");
  EXPECT_EQ(outcome_of(trust(), "127.0.0.2"),
            "the server's certificate is refused: IP address mismatch");
}

TEST_F(TlsPeers, APinnedCertificateIsThatOneOrNone) {
  // Of nobody, for no name that is asked for, and over.
  const Identity lonely = make_identity({"lonely", "DNS:elsewhere", -7200, -3600});
  write_certificate(files().certificate_chain, lonely);
  write_key(files().private_key, lonely);
  const std::string pin = ServerTls(files()).fingerprint();
  EXPECT_EQ(outcome_of({"", pin}), "");
  const Identity other = install({});
  EXPECT_EQ(outcome_of({"", pin}), "the server's certificate is refused: it is not the pinned one");
  EXPECT_EQ(outcome_of({file("ca.pem"), pin}),
            "the server's certificate is refused: it is not the pinned one");
}

TEST_F(TlsPeers, ReloadingTheCertificateDropsNobody) {
  ServerTls server(files());
  const client::ClientTls tls(trust());
  const auto name_of = [](Stream& stream) {
    const std::unique_ptr<X509, decltype(&X509_free)> certificate(
        SSL_get1_peer_certificate(stream.tls()->native_handle()), X509_free);
    char name[64] = {};
    X509_NAME_get_text_by_NID(X509_get_subject_name(certificate.get()), NID_commonName, name,
                              sizeof name);
    return std::string(name);
  };
  Handshake first;
  Handshake second;
  bool ended = false;
  spawn([&]() -> awaitable<void> {
    spawn([&] { return echo(server.current(), first); });
    Tcp::socket socket = co_await connected();
    Stream old(std::move(socket), tls.context());
    const std::string old_why = co_await greet(old, tls, "localhost");
    EXPECT_EQ(old_why, "");
    co_await exchange(old, 100'000);
    const std::string pin = server.fingerprint();

    // What cannot be read changes nothing.
    std::ofstream(files().private_key, std::ios::trunc) << "half a ";
    EXPECT_THAT(server.reload(), HasSubstr("server.key: is no private key"));
    EXPECT_EQ(server.fingerprint(), pin);

    install({"renewed", "DNS:localhost", -3600, 7200});
    EXPECT_EQ(server.reload(), "");
    EXPECT_NE(server.fingerprint(), pin);
    spawn([&] { return echo(server.current(), second); });
    Tcp::socket next_socket = co_await connected();
    Stream fresh(std::move(next_socket), tls.context());
    const std::string fresh_why = co_await greet(fresh, tls, "localhost");
    EXPECT_EQ(fresh_why, "");
    EXPECT_EQ(name_of(old), "test");
    EXPECT_EQ(name_of(fresh), "renewed");
    co_await exchange(old, 100'000);
    co_await exchange(fresh, 100'000);
    co_await hang_up(old);
    co_await hang_up(fresh);
    ended = true;
  });
  run();
  EXPECT_TRUE(ended);
}

TEST_F(TlsPeers, AHandshakeThatNeverEndsIsCutAtTheDeadlineWhateverBytesCome) {
  const ServerTls server(files());
  handshake_time_ = std::chrono::milliseconds(1000);
  for (const bool drips : {false, true}) {
    SCOPED_TRACE(drips);
    Handshake shaken;
    const auto begin = std::chrono::steady_clock::now();
    std::size_t dripped = 0;
    spawn([&] { return echo(server.current(), shaken); });
    spawn([&]() -> awaitable<void> {
      Tcp::socket socket = co_await connected();
      asio::error_code error;
      auto done = asio::redirect_error(asio::use_awaitable, error);
      // A record of the handshake of 16 KiB, a byte every 10 ms.
      const std::vector<unsigned char> head = {0x16, 0x03, 0x01, 0x40, 0x00,
                                               0x01, 0x00, 0x3f, 0xfc};
      asio::steady_timer timer(io_);
      while (drips && !error && dripped < 500) {
        const unsigned char byte = dripped < head.size() ? head[dripped] : 0x03;
        const auto out = asio::buffer(&byte, 1);
        co_await asio::async_write(socket, out, done);
        ++dripped;
        timer.expires_after(std::chrono::milliseconds(10));
        co_await timer.async_wait(asio::use_awaitable);
      }
      std::vector<std::byte> more(1);
      const auto in = asio::buffer(more);
      if (!drips) co_await socket.async_read_some(in, done);
      EXPECT_TRUE(error) << "the connection lives";
    });
    run();
    const auto took = std::chrono::steady_clock::now() - begin;
    EXPECT_EQ(shaken.end, Handshake::End::kOverdue) << shaken.reason;
    EXPECT_GE(took, std::chrono::milliseconds(1000));
    EXPECT_LT(took, std::chrono::seconds(10));
    EXPECT_EQ(dripped > 2, drips) << "what comes in does not put the deadline off";
  }
}

TEST_F(TlsPeers, TheServerSpeaksNothingBeforeTls12) {
  const ServerTls server(files());
  for (const int version : {TLS1_1_VERSION, TLS1_2_VERSION, TLS1_3_VERSION}) {
    SCOPED_TRACE(version);
    auto context = std::make_shared<asio::ssl::context>(asio::ssl::context::tls_client);
    SSL_CTX_set_max_proto_version(context->native_handle(), version);
    SSL_CTX_set_min_proto_version(context->native_handle(), version);
    SSL_CTX_set_cipher_list(context->native_handle(), "ALL:@SECLEVEL=0");
    Handshake shaken;
    bool good = false;
    bool forward_secret = false;
    spawn([&] { return echo(server.current(), shaken); });
    spawn([&]() -> awaitable<void> {
      Tcp::socket socket = co_await connected();
      Stream stream(std::move(socket), context);
      asio::error_code error;
      auto done = asio::redirect_error(asio::use_awaitable, error);
      co_await stream.async_handshake(asio::ssl::stream_base::client, done);
      good = !error;
      const std::string cipher = SSL_get_cipher(stream.tls()->native_handle());
      forward_secret = cipher.starts_with("ECDHE") || cipher.starts_with("TLS_");
      if (good) co_await hang_up(stream);
    });
    run();
    EXPECT_EQ(good, version >= TLS1_2_VERSION);
    EXPECT_EQ(forward_secret, version >= TLS1_2_VERSION);
    EXPECT_EQ(shaken.end == Handshake::End::kDone, good);
  }
}

TEST_F(TlsPeers, FilesThatAreNoneAreNamed) {
  const auto complaint = [&] {
    try {
      const ServerTls server(files());
      return std::string("taken");
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
  };
  const Identity good = install({});
  EXPECT_EQ(complaint(), "taken");
  write_key(files().private_key, make_identity({}));
  EXPECT_THAT(complaint(), HasSubstr("server.key: is no"));
  write_key(files().private_key, good, "secret");
  EXPECT_THAT(complaint(), HasSubstr("without a password"));
  write_key(files().private_key, good);
  std::ofstream(files().certificate_chain, std::ios::trunc) << "-----BEGIN CERTIFICATE-----\n";
  EXPECT_THAT(complaint(), HasSubstr("server.pem: is no certificate chain in PEM"));
  std::filesystem::remove(files().certificate_chain);
  EXPECT_THAT(complaint(), HasSubstr("server.pem: cannot be read"));
  EXPECT_THROW(client::ClientTls({file("none.pem"), ""}), std::runtime_error);
  EXPECT_THROW(client::ClientTls({"", "12:34"}), std::runtime_error);
}

TEST(Fingerprints, ComeBackFromTheirText) {
  transport::Fingerprint fingerprint{};
  for (std::size_t i = 0; i < fingerprint.size(); ++i)
    fingerprint[i] = static_cast<std::uint8_t>(i * 37);
  const std::string text = transport::fingerprint_text(fingerprint);
  EXPECT_EQ(transport::parse_fingerprint(text), fingerprint);
  std::string coloned;
  for (std::size_t i = 0; i < text.size(); i += 2)
    coloned += (i == 0 ? "" : ":") + text.substr(i, 2);
  for (char& letter : coloned) letter = static_cast<char>(std::toupper(letter));
  EXPECT_EQ(transport::parse_fingerprint(coloned), fingerprint);
  EXPECT_FALSE(transport::parse_fingerprint(text + "0").has_value());
  EXPECT_FALSE(transport::parse_fingerprint(text.substr(1)).has_value());
  EXPECT_FALSE(transport::parse_fingerprint("x" + text.substr(1)).has_value());
  EXPECT_FALSE(transport::parse_fingerprint("").has_value());
}

}  // namespace
}  // namespace cycloid::server
