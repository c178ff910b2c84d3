#include "server/operation/http_server.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <thread>
#include <vector>

#include "tests/server/http_fixture.hpp"

namespace cycloid::server {
namespace {

using namespace std::chrono_literals;

/// Says how many bytes it was sent, and reads none at "/".
HttpReply reply_to(const HttpRequest& request) {
  if (request.path == "/") return {200, "text/plain", "hello", ""};
  const HttpBody body = request.read_body();
  const std::string said = std::to_string(body.text.size());
  return {body.status, "text/plain", body.status == 200 ? said : body.mistake, ""};
}

class HttpServerTest : public testing::Test {
 protected:
  void open(std::chrono::milliseconds patience) {
    server_.emplace("127.0.0.1", std::uint16_t{0}, patience);
    server_->serve(reply_to);
  }
  Answer post(const std::string& head, const std::string& body) {
    return http_bytes(server_->port(), "POST /read HTTP/1.1\r\n" + head + "\r\n\r\n" + body);
  }

  std::optional<HttpServer> server_;
};

TEST(HttpServer, SaysThatItStartsUntilThereIsSomebodyToAnswer) {
  HttpServer server("127.0.0.1", 0);
  EXPECT_EQ(http(server.port(), "GET", "/").status, 503);
  server.serve([](const HttpRequest&) { return HttpReply{}; });
  EXPECT_EQ(http(server.port(), "GET", "/").status, 200);
}

TEST_F(HttpServerTest, ReadsAsMuchAsIsAnnounced) {
  open(20s);
  EXPECT_EQ(post("Content-Length: 0", "").body, "0");
  EXPECT_EQ(post("Content-Length: 3", "abcdef").body, "3");
  EXPECT_EQ(post("Content-Length: 65536", std::string(65536, 'x')).body, "65536");
  EXPECT_EQ(post("Content-Length: 65537", std::string(65537, 'x')).status, 413);
}

TEST_F(HttpServerTest, ABodyHasADeadlineAsAWhole) {
  open(1500ms);  // Which the head has to be sent in, too.
  EXPECT_EQ(post("Content-Length: 3", "ab").status, 408);
  asio::io_context io;
  std::vector<asio::ip::tcp::socket> slow;
  const std::string head = "POST /read HTTP/1.1\r\nContent-Length: 60000\r\n\r\n";
  for (int i = 0; i < HttpServer::kConnections; ++i) {
    slow.emplace_back(io).connect({asio::ip::address_v4::loopback(), server_->port()});
    asio::write(slow.back(), asio::buffer(head));
  }
  // For 10 s at most, so that a server without a deadline fails and does not hang.
  const std::jthread drips([&](const std::stop_token& stop) {
    for (int i = 0; i < 200 && !stop.stop_requested(); ++i) {
      asio::error_code ignored;
      for (auto& socket : slow) asio::write(socket, asio::buffer("x", 1), ignored);
      std::this_thread::sleep_for(50ms);
    }
  });
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(http(server_->port(), "GET", "/").status, 200);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 8s) << "it waited for all of the bodies";
}

}  // namespace
}  // namespace cycloid::server
