#pragma once

#include <memory>
#include <optional>

#include "server/operation/admin.hpp"
#include "server/operation/metrics.hpp"

namespace cycloid::server {

struct OperationOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;               ///< 0: any.
  std::uint32_t missed_ticks_max = 60;  ///< /livez fails where a room misses more.
  std::optional<AdminOptions> admin;    ///< None: its paths do not exist.
};

/// What others watch and steer a host by, over HTTP: /metrics, /livez, /readyz and /admin/...
class Operation {
 public:
  /// To be called before the host is made: where the address cannot be had, no log is begun.
  /// @throws std::system_error where the address cannot be bound.
  static std::unique_ptr<HttpServer> bind(const OperationOptions& options);

  /// Binds by itself: for a host that has no log to begin.
  Operation(Host& host, OperationOptions options) : Operation(host, options, bind(options)) {}
  /// @param host  Outlives this.
  /// @param server  What `bind` gave for the same options; not null.
  Operation(Host& host, OperationOptions options, std::unique_ptr<HttpServer> server);

  std::uint16_t port() const { return server_->port(); }

 private:
  HttpReply handle(const HttpRequest& request);

  Host& host_;
  OperationOptions options_;
  HostMetrics metrics_;
  std::unique_ptr<Admin> admin_;
  std::unique_ptr<HttpServer> server_;  ///< Last: it calls the others until it is gone.
};

}  // namespace cycloid::server
