#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

struct mg_connection;
struct mg_context;

namespace cycloid::server {

struct HttpBody {
  std::string text;     ///< "" where it could not be had.
  int status = 200;     ///< Then 400, 408, 411 or 413.
  std::string mistake;  ///< Then why, as a sentence.
};

struct HttpRequest {
  std::string method;  ///< "GET"
  std::string path;    ///< Decoded, without a query.
  std::string authorization;
  std::string from;  ///< Address and port.
  /// Reads what comes behind the head, for which the thread waits: only for whom that is worth it.
  /// To be called once at most, and before the handler returns.
  std::function<HttpBody()> read_body;
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
  /// Served side by side, a thread each: so many must be silent before others wait.
  static constexpr int kConnections = 64;
  static constexpr std::chrono::milliseconds kPatience{5000};

  /// Whether addresses of IPv6 can be bound: the library may be built without.
  static bool knows_ipv6();

  /// Binds the address; whoever comes before `serve` is told 503.
  /// @param port  0: any.
  /// @param patience  With a head, and from there with the whole of a body.
  /// @throws std::system_error where the address cannot be bound.
  HttpServer(const std::string& address, std::uint16_t port,
             std::chrono::milliseconds patience = kPatience);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();

  /// @param handler  Called on the server's threads, several at a time. Once.
  void serve(Handler handler);
  std::uint16_t port() const;

 private:
  static int on_request(mg_connection* connection, void* data);

  HttpReply reply_to(const HttpRequest& request) const;

  Handler handler_;
  std::atomic<bool> serves_{false};  ///< From then on nobody writes the handler.
  std::chrono::milliseconds patience_;
  mg_context* context_ = nullptr;
};

}  // namespace cycloid::server
