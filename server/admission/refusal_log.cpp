#include "server/admission/refusal_log.hpp"

#include <array>

#include "protocol/text.hpp"
#include "protocol/utf8.hpp"

namespace cycloid::server {
namespace {

constexpr std::size_t kLineReasonBytesMax = 256;
constexpr std::int64_t kCauseSweepInterval_ns = 1'000'000'000;

}  // namespace

RefusalLog::Cause* RefusalLog::cause_of(protocol::Refusal code, const PeerAddress& address,
                                        std::int64_t now_ns) {
  const auto key = std::pair(code, address.host());
  const auto known = causes_.find(key);
  if (known != causes_.end()) return &known->second;
  if (causes_.size() >= options_.causes_max && now_ns >= next_sweep_ns_) {
    next_sweep_ns_ = now_ns + kCauseSweepInterval_ns;
    std::erase_if(causes_, [&](const auto& each) {
      const bool over = each.second.quiet_until_ns <= now_ns;
      if (over) suppressed_elsewhere_ += each.second.suppressed;
      return over;
    });
  }
  if (causes_.size() >= options_.causes_max) return nullptr;
  return &causes_[key];
}

RefusalLog::Line RefusalLog::note(protocol::Refusal code, const PeerAddress& address,
                                  std::int64_t now_ns) {
  Cause* const cause = cause_of(code, address, now_ns);
  const bool quiet = cause != nullptr && now_ns < cause->quiet_until_ns;
  if (quiet || !lines_.take(1, now_ns)) {
    ++suppressed_total_;
    ++(cause != nullptr ? cause->suppressed : suppressed_elsewhere_);
    return {};
  }
  Line line{true, suppressed_elsewhere_};
  suppressed_elsewhere_ = 0;
  if (cause != nullptr) {
    line.suppressed += cause->suppressed;
    *cause = {now_ns + options_.repeat_ns, 0};
  }
  return line;
}

std::string refusal_line(protocol::Refusal code, const std::string& reason,
                         const PeerAddress& address, std::uint64_t suppressed) {
  // A peer's own words come back in some reasons.
  const std::string said = protocol::printable(protocol::cut_utf8(reason, kLineReasonBytesMax));
  std::string line = "refused " + address.text() + ": " + protocol::refusal_name(code) + " (" +
                     std::to_string(static_cast<int>(code)) + "): " + said;
  if (suppressed > 0) line += " (and " + std::to_string(suppressed) + " more since)";
  return line;
}

}  // namespace cycloid::server
