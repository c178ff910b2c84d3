#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

struct mg_context;

namespace cycloid::server {

struct HttpRequest {
  std::string method;  ///< "GET"
  std::string path;    ///< Decoded, without a query.
  std::string authorization;
  std::string body;
  bool body_too_large = false;  ///< Then `body` is empty.
  bool body_cut = false;        ///< It ended before all that was announced had come.
  std::string from;             ///< Address and port.
};

struct HttpReply {
  int status = 200;
  std::string type = "application/json";
  std::string body;
  std::string allow;  ///< The methods, of a 405.
};

/// A small HTTP/1.1 server (CivetWeb) on threads of its own.
class HttpServer {
 public:
  using Handler = std::function<HttpReply(const HttpRequest&)>;
  static constexpr std::size_t kBodyBytesMax = 65536;
  /// Served side by side, a thread each: so many must be silent, for 5 s, before others wait.
  static constexpr int kConnections = 64;

  /// @param port  0: any.
  /// @param handler  Called on the server's threads, several at a time.
  /// @throws std::system_error where the address cannot be bound.
  HttpServer(const std::string& address, std::uint16_t port, Handler handler);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();

  std::uint16_t port() const;

 private:
  Handler handler_;
  mg_context* context_ = nullptr;
};

}  // namespace cycloid::server
