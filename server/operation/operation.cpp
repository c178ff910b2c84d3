#include "server/operation/operation.hpp"

#include <utility>

namespace cycloid::server {
namespace {

HttpReply plain_text(int status, const std::string& body) {
  return {status, "text/plain; charset=utf-8", body + "\n", ""};
}

std::unique_ptr<Admin> make_admin(Host& host, const OperationOptions& options) {
  return options.admin ? std::make_unique<Admin>(host, *options.admin) : nullptr;
}

}  // namespace

std::unique_ptr<HttpServer> Operation::bind(const OperationOptions& options) {
  return std::make_unique<HttpServer>(options.address, options.port);
}

Operation::Operation(Host& host, OperationOptions options, std::unique_ptr<HttpServer> server)
    : host_(host),
      options_(std::move(options)),
      metrics_(host),
      admin_(make_admin(host, options_)),
      server_(std::move(server)) {
  server_->serve([this](const HttpRequest& request) { return handle(request); });
  host_.logger()->info("metrics and health at {} port {}", options_.address, port());
}

HttpReply Operation::handle(const HttpRequest& request) {
  if (request.path == "/admin" || request.path.starts_with("/admin/")) {
    if (admin_) return admin_->handle(request);
    return plain_text(404, "the admin interface is off: admin.token_file is not configured");
  }
  const bool known =
      request.path == "/metrics" || request.path == "/livez" || request.path == "/readyz";
  if (!known) return plain_text(404, "paths: /metrics, /livez, /readyz, /admin/rooms");
  if (request.method != "GET" && request.method != "HEAD") {
    HttpReply reply = plain_text(405, "this path takes GET");
    reply.allow = "GET";
    return reply;
  }
  if (request.path == "/metrics") {
    return {200, "text/plain; version=0.0.4; charset=utf-8", metrics_.text(), ""};
  }
  if (request.path == "/readyz") {
    return host_.draining() ? plain_text(503, "draining") : plain_text(200, "ready");
  }
  const std::string stuck = host_.stuck(options_.missed_ticks_max);
  return stuck.empty() ? plain_text(200, "alive") : plain_text(503, stuck);
}

}  // namespace cycloid::server
