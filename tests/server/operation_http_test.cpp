#include <asio.hpp>
#include <chrono>

#include "tests/server/operation_fixture.hpp"

namespace cycloid::server {
namespace {

using namespace std::chrono_literals;

TEST_F(OperationTest, WhoSaysNothingKeepsNobodyWaiting) {
  open();
  asio::io_context io;
  std::vector<asio::ip::tcp::socket> silent;
  for (int i = 0; i < HttpServer::kConnections / 2; ++i)
    silent.emplace_back(io).connect({asio::ip::address_v4::loopback(), operation_->port()});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(get("/livez").status, 200);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(4))
      << "it waited for one of them to be given up";
}

TEST_F(OperationTest, OfAHeadOnlyTheHeadIsSent) {
  open();
  for (const char* path : {"/livez", "/metrics", "/nothing", "/admin/rooms"}) {
    const Answer whole = get(path);
    const Answer head = http(operation_->port(), "HEAD", path);
    EXPECT_EQ(head.body, "") << path;
    EXPECT_NE(head.head.find("Content-Length: "), std::string::npos) << path;
    EXPECT_GT(whole.body.size(), 0u) << path;
  }
}

TEST_F(OperationTest, APathWithANulIsAMistakeAndNotTheOneBeforeIt) {
  open();
  EXPECT_EQ(get("/readyz").status, 200);
  EXPECT_EQ(get("/ready%7A").status, 200);
  EXPECT_EQ(get("/readyz%00x").status, 400);
  EXPECT_EQ(post("/admin/rooms/arena/lock%00").status, 400);
  EXPECT_EQ(post("/admin/rooms/arena/lock%2500").status, 404);
  EXPECT_FALSE(server_->host().find("arena")->locked());
  EXPECT_EQ(post("/admin/rooms/ar%65na/lock").status, 200);
}

TEST_F(OperationTest, WhoMayNotActIsAnsweredBeforeItsBodyHasCome) {
  open();
  for (const char* line : {"GET /livez", "POST /livez", "POST /admin/drain"}) {
    asio::io_context io;
    asio::ip::tcp::socket socket(io);
    socket.connect({asio::ip::address_v4::loopback(), operation_->port()});
    const auto begin = std::chrono::steady_clock::now();
    const std::string head = std::string(line) + " HTTP/1.1\r\nContent-Length: 60000\r\n\r\n";
    asio::write(socket, asio::buffer(head));
    std::string reply;
    asio::error_code error;
    asio::read_until(socket, asio::dynamic_buffer(reply), "\r\n\r\n", error);
    EXPECT_TRUE(reply.starts_with("HTTP/1.1 ")) << line;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 4s) << line;
  }
}

TEST_F(OperationTest, ABodyThatIsCutOffIsAMistakeAndNothingIsDone) {
  open();
  const auto cut = [&](const std::string& path, const std::string& body) {
    const std::string head = "POST " + path + " HTTP/1.1\r\nAuthorization: Bearer " + kAdminToken;
    return http_bytes(operation_->port(), head + "\r\nContent-Length: 22\r\n\r\n" + body, true);
  };
  for (const char* path : {"/admin/drain", "/admin/rooms/arena/lock", "/admin/rooms/arena/end"}) {
    for (const char* body : {"", "{}", "{\"deadline_ms\""}) {
      const Answer answer = cut(path, body);
      EXPECT_EQ(answer.status, 400) << path << body;
      EXPECT_EQ(error_of(answer), "body: it ends before all of it has come") << path << body;
    }
  }
  const auto room = server_->host().find("arena");
  ASSERT_TRUE(room);
  EXPECT_EQ(room->stage(), LifeStage::kRunning);
  EXPECT_FALSE(room->locked());
  EXPECT_FALSE(server_->host().draining());
  EXPECT_NE(close().find(R"("audit":"/admin/drain","from")"), std::string::npos)
      << "on record, too";
}

TEST_F(OperationTest, ABodyInChunksIsRefusedForItMayBeCutOff) {
  open();
  const std::string head = std::string("POST /admin/drain HTTP/1.1\r\nAuthorization: Bearer ") +
                           kAdminToken + "\r\nTransfer-Encoding: chunked\r\n\r\n";
  for (const char* body : {"", "2\r\n{}\r\n", "2\r\n{}\r\n0\r\n\r\n"}) {
    const Answer answer = http_bytes(operation_->port(), head + body, true);
    EXPECT_EQ(answer.status, 411) << body;
    EXPECT_TRUE(error_of(answer).starts_with("body: it comes in chunks")) << answer.body;
  }
  EXPECT_FALSE(server_->host().draining());
}

TEST_F(OperationTest, AnActThatNoRoomAnswersAnyMoreIsRefusedAtOnce) {
  open();
  server_->stop();
  (void)server_->report();
  const auto begin = std::chrono::steady_clock::now();
  const Answer answer = post("/admin/rooms", R"({"name": "duel-1", "template": "hall"})");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 4s);
  EXPECT_EQ(answer.status, 503);
  EXPECT_EQ(error_of(answer), "the server goes away");
}

}  // namespace
}  // namespace cycloid::server
