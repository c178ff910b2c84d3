#pragma once

#include <functional>
#include <string>
#include <vector>

#include "protocol/log_format.hpp"
#include "scenes/catalogue.hpp"
#include "tests/cli/program.hpp"

namespace cycloid::cli {

/// Reads a log, lets `change` have its way with it, and writes it again with checks that fit.
inline void rewrite_log(const std::string& from, const std::string& to,
                        const std::function<void(protocol::Log&)>& change) {
  const std::string text = read_text(from);
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  protocol::Log log = protocol::read_log({begin, text.size()});
  change(log);
  protocol::Bytes bytes;
  protocol::LogEncoder encoder(log.header, bytes);
  for (const protocol::LogTick& tick : log.ticks) encoder.tick(tick, bytes);
  if (log.footer) encoder.footer(*log.footer, bytes);
  write_text(to, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace cycloid::cli
