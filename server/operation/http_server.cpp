#include "server/operation/http_server.hpp"

#include <civetweb.h>

#include <cerrno>
#include <exception>
#include <system_error>
#include <utility>

namespace cycloid::server {
namespace {

/// Reads what the request announces, below 0 where it does not say, up to the bound.
void read_body(mg_connection* connection, long long announced, HttpRequest& request) {
  constexpr auto kMost = static_cast<long long>(HttpServer::kBodyBytesMax);
  request.body_too_large = announced > kMost;
  char piece[4096];
  while (!request.body_too_large) {
    const int count = mg_read(connection, piece, sizeof piece);
    if (count <= 0) break;
    request.body.append(piece, static_cast<std::size_t>(count));
    request.body_too_large = std::cmp_greater(request.body.size(), kMost);
  }
  if (request.body_too_large) request.body.clear();
  request.body_cut = !request.body_too_large && std::cmp_less(request.body.size(), announced);
}

void send(mg_connection* connection, const HttpReply& reply) {
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
  (void)mg_write(connection, reply.body.data(), reply.body.size());
}

int on_request(mg_connection* connection, void* data) {
  const mg_request_info* info = mg_get_request_info(connection);
  HttpRequest request;
  request.method = info->request_method;
  request.path = info->local_uri == nullptr ? "" : info->local_uri;
  request.from = std::string(info->remote_addr) + ":" + std::to_string(info->remote_port);
  if (const char* word = mg_get_header(connection, "Authorization")) request.authorization = word;
  read_body(connection, info->content_length, request);
  HttpReply reply;
  try {
    reply = (*static_cast<HttpServer::Handler*>(data))(request);
  } catch (const std::exception& error) {  // Of memory: the library's C code must not see it.
    reply = {500, "text/plain", error.what(), ""};
  }
  send(connection, reply);
  return reply.status;
}

}  // namespace

HttpServer::HttpServer(const std::string& address, std::uint16_t port, Handler handler)
    : handler_(std::move(handler)) {
  const bool v6 = address.find(':') != std::string::npos;
  const std::string at = (v6 ? "[" + address + "]" : address) + ":" + std::to_string(port);
  const std::string threads = std::to_string(kConnections);
  const char* options[] = {"listening_ports",
                           at.c_str(),
                           "num_threads",
                           threads.c_str(),
                           "request_timeout_ms",
                           "5000",
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
  mg_set_request_handler(context_, "/", on_request, &handler_);
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
