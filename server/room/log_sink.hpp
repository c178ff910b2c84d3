#pragma once

#include <string>

#include "protocol/log_format.hpp"

namespace cycloid::server {

/// Where a room hands its ticks, in order, each before any client hears of it.
class LogSink {
 public:
  virtual ~LogSink() = default;
  virtual void tick(const protocol::LogTick& tick) = 0;
  virtual void close(const protocol::LogFooter& footer) = 0;
  /// False once a tick could not be kept; never true again.
  virtual bool durable() const = 0;
  virtual std::string error() const = 0;
};

}  // namespace cycloid::server
