#include <gtest/gtest.h>
#include <stdlib.h>

#include <asio/ssl.hpp>
#include <filesystem>

#include "tests/server/certificates.hpp"
#include "tests/server/config_fixture.hpp"
#include "tests/server/http_fixture.hpp"

namespace cycloid::server {
namespace {

/// A client through TLS that blocks, and checks the certificate.
class TlsHostPeer {
 public:
  TlsHostPeer(std::uint16_t port, const std::string& authority_file) {
    context_.load_verify_file(authority_file);
    stream_.set_verify_mode(asio::ssl::verify_peer);
    stream_.next_layer().connect({asio::ip::address_v4::loopback(), port});
    const timeval patience{std::chrono::seconds(kHostPatience).count(), 0};
    (void)::setsockopt(stream_.next_layer().native_handle(), SOL_SOCKET, SO_RCVTIMEO, &patience,
                       sizeof patience);
    stream_.handshake(asio::ssl::stream_base::client);
  }

  void greet(const std::string& room) {
    protocol::Hello hello;
    hello.scene_digest = scenes::scene_digest(two_seat_scene());
    hello.room = room;
    send(hello);
  }
  void send(const protocol::ClientMessage& message) {
    asio::write(stream_, asio::buffer(protocol::encode(message)));
  }
  /// The next message of a type, or nothing at the end of the connection.
  template <class Message>
  std::optional<Message> wait_for() {
    for (;;) {
      while (const auto payload = framer_.next()) {
        const auto decoded = protocol::decode_server(*payload);
        if (!decoded.message) return {};
        if (const auto* it = std::get_if<Message>(&*decoded.message)) return *it;
      }
      std::array<std::byte, 4096> bytes;
      asio::error_code error;
      const std::size_t count = stream_.read_some(asio::buffer(bytes), error);
      if (error) return {};
      (void)framer_.feed(std::span<const std::byte>(bytes).first(count));
    }
  }
  /// What ends the connection, whatever is said before.
  asio::error_code wait_for_end() {
    std::array<std::byte, 4096> bytes;
    asio::error_code error;
    while (!error) (void)stream_.read_some(asio::buffer(bytes), error);
    return error;
  }
  /// "CN" of the server's certificate.
  std::string server_name() {
    const std::unique_ptr<X509, void (*)(X509*)> certificate(
        SSL_get1_peer_certificate(stream_.native_handle()), X509_free);
    char name[64] = "";
    X509_NAME_get_text_by_NID(X509_get_subject_name(certificate.get()), NID_commonName, name,
                              sizeof name);
    return name;
  }

 private:
  asio::io_context io_{1};
  asio::ssl::context context_{asio::ssl::context::tls_client};
  asio::ssl::stream<asio::ip::tcp::socket> stream_{io_, context_};
  protocol::Framer framer_{protocol::kServerMessageBytesMax};
};

/// A host that speaks TLS only, with files in a folder of its own.
class HostTls : public testing::Test {
 protected:
  HostTls() {
    std::string pattern = (std::filesystem::temp_directory_path() / "cycloid-tls-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    authority_ = make_identity({"authority", "", -3600, 3600});
    write_certificate(file("ca.pem"), authority_);
    install("first");
  }
  ~HostTls() override { std::filesystem::remove_all(folder_); }

  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  void install(const std::string& name) {
    CertificateWish wish;
    wish.name = name;
    const Identity identity = make_identity(wish, &authority_);
    write_certificate(file("server.pem"), identity);
    write_key(file("server.key"), identity);
  }

  std::filesystem::path folder_;
  Identity authority_;
};

TEST_F(HostTls, AMatchIsPlayedThroughIt) {
  HostLines lines;
  HostOptions options = quiet_host(lines);
  options.tls = std::make_shared<ServerTls>(TlsFiles{file("server.pem"), file("server.key")});
  options.rooms.push_back({"arena", two_seat_settings()});
  RunningHost server(std::move(options));
  TlsHostPeer peer(server.port(), file("ca.pem"));
  peer.greet("arena");
  const auto welcome = peer.wait_for<protocol::Welcome>();
  ASSERT_TRUE(welcome);
  ASSERT_TRUE(peer.wait_for<protocol::SnapshotPart>());
  std::uint64_t given = 0;
  std::uint64_t last = welcome->tick;
  for (int i = 0; i < 120; ++i) {
    const auto frame = peer.wait_for<protocol::InputFrame>();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->tick, ++last);
    given +=
        frame->seats[static_cast<std::size_t>(welcome->seat)].origin == protocol::Origin::kGiven;
    peer.send(protocol::Input{frame->tick + 6, push(100)});
  }
  EXPECT_GT(given, 60u);
  peer.send(protocol::Ping{77});
  const auto pong = peer.wait_for<protocol::Pong>();
  ASSERT_TRUE(pong);
  EXPECT_EQ(pong->token, 77u);
  ASSERT_TRUE(server.act("arena", LifeAct::kEnd).ok());
  const auto bye = peer.wait_for<protocol::Bye>();
  ASSERT_TRUE(bye);
  EXPECT_EQ(bye->reason, "by the test");
}

TEST_F(HostTls, WhoSpeaksPlainlyIsToldSo) {
  HostLines lines;
  HostOptions options = quiet_host(lines);
  options.tls = std::make_shared<ServerTls>(TlsFiles{file("server.pem"), file("server.key")});
  options.rooms.push_back({"arena", two_seat_settings()});
  RunningHost server(std::move(options));
  HostPeer peer(server.port());
  peer.greet("arena");
  const auto refused = peer.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->reason, "this server speaks TLS only");
}

TEST_F(HostTls, WhoSaysNoHelloInTimeIsToldSo) {
  HostLines lines;
  HostOptions options = quiet_host(lines);
  options.tls = std::make_shared<ServerTls>(TlsFiles{file("server.pem"), file("server.key")});
  options.gate.hello_deadline_ns = 500'000'000;
  options.rooms.push_back({"arena", two_seat_settings()});
  RunningHost server(std::move(options));
  TlsHostPeer peer(server.port(), file("ca.pem"));
  const auto refused = peer.wait_for<protocol::Refused>();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, protocol::Refusal::kTooSlow);
  EXPECT_NE(refused->reason, "");
  EXPECT_EQ(peer.wait_for_end(), asio::error::eof) << "with the farewell of TLS";
}

TEST_F(HostTls, AReloadTakesTheNewCertificateAndKeepsWhoIsThere) {
  const ConfigFile config("tls-reload");
  const ConfigFile token("tls-token");
  token.write(std::string(kAdminToken) + "\n");
  config.write("[server]\nport = 0\n[operation]\nport = 0\n[admin]\ntoken_file = \"" +
               token.path() + "\"\n[tls]\nmode = \"required\"\ncertificate_file = \"" +
               file("server.pem") + "\"\nkey_file = \"" + file("server.key") + "\"\n" +
               kConfigRooms);
  const Configured server(config);
  const auto reload = [&] {
    return http(server.at().operation_port, "POST", "/admin/reload").status;
  };
  TlsHostPeer before(server.at().port, file("ca.pem"));
  EXPECT_EQ(before.server_name(), "first");
  before.greet("arena");
  ASSERT_TRUE(before.wait_for<protocol::Welcome>());
  install("second");
  EXPECT_EQ(reload(), 200);
  TlsHostPeer after(server.at().port, file("ca.pem"));
  EXPECT_EQ(after.server_name(), "second");
  after.greet("arena");
  EXPECT_TRUE(after.wait_for<protocol::Welcome>());
  EXPECT_TRUE(before.wait_for<protocol::InputFrame>());
  std::filesystem::remove(file("server.key"));
  EXPECT_EQ(reload(), 422);
  TlsHostPeer still(server.at().port, file("ca.pem"));
  EXPECT_EQ(still.server_name(), "second");
}

}  // namespace
}  // namespace cycloid::server
