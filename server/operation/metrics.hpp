#pragma once

#include <prometheus/collectable.h>

#include "server/host/host.hpp"

namespace cycloid::server {

/// What the host and its rooms show of themselves, as Prometheus knows it; docs/server.md lists the
/// names. Reads meters only: neither a tick nor a connection waits for a scrape.
class HostMetrics final : public prometheus::Collectable {
 public:
  explicit HostMetrics(const Host& host) : host_(host) {}

  std::vector<prometheus::MetricFamily> Collect() const override;
  /// In the text format 0.0.4.
  std::string text() const;

 private:
  const Host& host_;
};

/// "too_slow" of kTooSlow: the label `code` of refusals.
const char* refusal_label(protocol::Refusal code);

}  // namespace cycloid::server
