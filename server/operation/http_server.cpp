#include "server/operation/http_server.hpp"

#include <civetweb.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <system_error>
#include <utility>

namespace cycloid::server {
namespace {

/// What comes behind the head of a request.
///
/// The library waits anew for each byte, so it is asked for one at a time: who sends one now and
/// then is given up at the deadline all the same.
class BodyReader {
 public:
  using Clock = std::chrono::steady_clock;

  BodyReader(mg_connection* connection, std::chrono::milliseconds patience)
      : connection_(connection),
        announced_(mg_get_request_info(connection)->content_length),
        in_chunks_(mg_get_header(connection, "Transfer-Encoding") != nullptr),
        patience_(patience),
        deadline_(Clock::now() + patience) {}

  HttpBody read() {
    // Whether chunks were cut off the library does not say.
    if (in_chunks_) return {"", 411, "body: it comes in chunks, and must have a Content-Length"};
    if (announced_ > kMost) return too_large();
    std::string text;
    int count = 1;
    for (char byte = 0; (count = next(byte)) > 0;) text += byte;
    if (std::cmp_greater_equal(text.size(), announced_)) return {std::move(text), 200, ""};
    if (count < 0) return {"", 400, "body: it ends before all of it has come"};
    return {"", 408,
            "body: not all of it has come within " + std::to_string(patience_.count()) + " ms"};
  }

  /// Takes what is still on its way: it would reset the connection as it closes, and with it the
  /// reply.
  void hear_out() {
    char byte = 0;
    for (long long i = 0; i < 2 * kMost && !in_chunks_ && next(byte) > 0; ++i) {
    }
  }

 private:
  static constexpr auto kMost = static_cast<long long>(HttpServer::kBodyBytesMax);

  static HttpBody too_large() {
    return {"", 413, "body: more than " + std::to_string(kMost) + " bytes"};
  }

  /// 1, 0 at the deadline or where nothing is left of the body, -1 at the end of the connection.
  int next(char& byte) { return Clock::now() < deadline_ ? mg_read(connection_, &byte, 1) : 0; }

  mg_connection* connection_;
  long long announced_;  ///< Below 0 where there is none.
  bool in_chunks_;
  std::chrono::milliseconds patience_;
  Clock::time_point deadline_;
};

std::string decoded(const char* uri) {
  const std::string path(uri == nullptr ? "" : uri);
  // As long as before, and a NUL behind it.
  std::string into(path.size() + 1, '\0');
  const int size = mg_url_decode(path.data(), static_cast<int>(path.size()), into.data(),
                                 static_cast<int>(into.size()), 0);
  into.resize(static_cast<std::size_t>(std::max(size, 0)));
  return into;
}

/// @param head_only  The body, whose length is told, is not sent.
void send(mg_connection* connection, const HttpReply& reply, bool head_only) {
  mg_response_header_start(connection, reply.status);
  mg_response_header_add(connection, "Content-Type", reply.type.c_str(), -1);
  mg_response_header_add(connection, "Content-Length", std::to_string(reply.body.size()).c_str(),
                         -1);
  mg_response_header_add(connection, "Cache-Control", "no-store", -1);
  if (reply.status == 401) mg_response_header_add(connection, "WWW-Authenticate", "Bearer", -1);
  if (!reply.allow.empty()) {
    mg_response_header_add(connection, "Allow", reply.allow.c_str(), -1);
  }
  mg_response_header_send(connection);
  if (!head_only) (void)mg_write(connection, reply.body.data(), reply.body.size());
}

}  // namespace

int HttpServer::on_request(mg_connection* connection, void* data) {
  const auto* server = static_cast<const HttpServer*>(data);
  const mg_request_info* info = mg_get_request_info(connection);
  // The library would wait for all that was announced, however slowly it comes.
  mg_disable_connection_keep_alive(connection);
  BodyReader body(connection, server->patience_);
  HttpRequest request;
  request.method = info->request_method;
  request.path = decoded(info->local_uri);
  request.from = std::string(info->remote_addr) + ":" + std::to_string(info->remote_port);
  if (const char* word = mg_get_header(connection, "Authorization")) request.authorization = word;
  request.read_body = [&body] { return body.read(); };
  const HttpReply reply = server->reply_to(request);
  send(connection, reply, request.method == "HEAD");
  body.hear_out();
  return reply.status;
}

HttpReply HttpServer::reply_to(const HttpRequest& request) const {
  if (request.path.find('\0') != std::string::npos) {
    return {400, "text/plain", "path: it holds a NUL\n", ""};
  }
  if (!serves_) return {503, "text/plain", "the server starts\n", ""};
  try {
    return handler_(request);
  } catch (const std::exception& error) {  // Of memory: the library's C code must not see it.
    return {500, "text/plain", error.what(), ""};
  }
}

void HttpServer::serve(Handler handler) {
  handler_ = std::move(handler);
  serves_ = true;
}

bool HttpServer::knows_ipv6() {
  return mg_check_feature(MG_FEATURES_IPV6) != 0;
}

HttpServer::HttpServer(const std::string& address, std::uint16_t port,
                       std::chrono::milliseconds patience)
    : patience_(patience) {
  const bool v6 = address.find(':') != std::string::npos;
  const std::string at = (v6 ? "[" + address + "]" : address) + ":" + std::to_string(port);
  const std::string threads = std::to_string(kConnections);
  const std::string timeout_ms = std::to_string(patience.count());
  const char* options[] = {"listening_ports",
                           at.c_str(),
                           "num_threads",
                           threads.c_str(),
                           "request_timeout_ms",
                           timeout_ms.c_str(),
                           "decode_url",  // It would end a path at a NUL.
                           "no",
                           "enable_keep_alive",
                           "no",
                           "max_request_size",
                           "16384",
                           "linger_timeout_ms",
                           "1000",
                           "tcp_nodelay",
                           "1",
                           "enable_auth_domain_check",
                           "no",
                           nullptr};
  mg_callbacks callbacks{};
  callbacks.log_message = [](const mg_connection*, const char*) { return 1; };  // Said by us.
  mg_init_library(0);
  errno = 0;
  context_ = mg_start(&callbacks, nullptr, options);
  if (context_ == nullptr) {
    const int why = errno == 0 ? EADDRNOTAVAIL : errno;
    throw std::system_error(why, std::generic_category(), at + " (operation)");
  }
  mg_set_request_handler(context_, "/", on_request, this);
}

HttpServer::~HttpServer() {
  mg_stop(context_);
  mg_exit_library();
}

std::uint16_t HttpServer::port() const {
  mg_server_port bound[1] = {};
  if (mg_get_server_ports(context_, 1, bound) < 1) return 0;
  return static_cast<std::uint16_t>(bound[0].port);
}

}  // namespace cycloid::server
