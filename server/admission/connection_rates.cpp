#include "server/admission/connection_rates.hpp"

#include <algorithm>

namespace cycloid::server {
namespace {

std::string over(const char* what, const Rate& rate) {
  return std::string("more than ") + std::to_string(rate.per_s) + " " + what + " per second, and " +
         std::to_string(rate.burst) + " at once";
}

}  // namespace

ConnectionRates::ConnectionRates(const ConnectionRateOptions& options, std::int64_t now_ns)
    : options_(options), messages_(options.messages, now_ns), bytes_(options.bytes, now_ns) {}

std::string ConnectionRates::take_message(std::uint32_t payload_bytes, std::int64_t now_ns) {
  if (!messages_.take(1, now_ns)) return over("messages", options_.messages);
  if (!bytes_.take(payload_bytes, now_ns)) return over("bytes", options_.bytes);
  return "";
}

std::string ConnectionRates::take_input(std::uint64_t tick) {
  if (tick > newest_tick_) {
    const std::uint64_t passed = std::min(tick - newest_tick_, kInputWindowTicks);
    for (std::uint64_t i = 0; i < passed; ++i) inputs_[(tick - i) % kInputWindowTicks] = 0;
    newest_tick_ = tick;
  }
  std::uint8_t& count = inputs_[tick % kInputWindowTicks];
  if (count >= options_.inputs_per_tick_max) {
    return "more than " + std::to_string(options_.inputs_per_tick_max) + " inputs for tick " +
           std::to_string(tick);
  }
  ++count;
  return "";
}

}  // namespace cycloid::server
