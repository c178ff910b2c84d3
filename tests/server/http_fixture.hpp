#pragma once

#include <asio.hpp>
#include <cstdint>
#include <string>

namespace cycloid::server {

inline constexpr const char* kAdminToken = "a-token-for-tests-only";

/// What a server has answered to a request.
struct Answer {
  int status = 0;
  std::string head;
  std::string body;
};

/// What a server says to these bytes, until it hangs up.
inline Answer http_bytes(std::uint16_t port, const std::string& bytes, bool hang_up = false) {
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  socket.connect({asio::ip::address_v4::loopback(), port});
  asio::error_code ignored;
  asio::write(socket, asio::buffer(bytes), ignored);
  if (hang_up) socket.shutdown(asio::socket_base::shutdown_send, ignored);
  std::string reply;
  asio::read(socket, asio::dynamic_buffer(reply), ignored);
  Answer answer;
  const std::size_t split = reply.find("\r\n\r\n");
  if (split == std::string::npos) return answer;
  answer.head = reply.substr(0, split);
  answer.body = reply.substr(split + 4);
  answer.status = std::stoi(reply.substr(9, 3));
  return answer;
}

/// One HTTP request over a connection of its own.
inline Answer http(std::uint16_t port, const std::string& method, const std::string& path,
                   const std::string& body = "", const std::string& token = kAdminToken) {
  std::string request = method + " " + path + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
                        std::to_string(body.size()) + "\r\nConnection: close\r\n";
  if (!token.empty()) request += "Authorization: Bearer " + token + "\r\n";
  return http_bytes(port, request + "\r\n" + body);
}

}  // namespace cycloid::server
