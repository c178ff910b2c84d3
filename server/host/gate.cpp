#include "server/host/gate.hpp"

namespace cycloid::server {
namespace {

Verdict refusal(protocol::Refusal code, std::string reason) {
  Verdict verdict;
  verdict.kind = Verdict::Kind::kRefuse;
  verdict.refused = {code, std::move(reason)};
  return verdict;
}

}  // namespace

Verdict HelloGate::arrive(NewcomerId id, const std::string& address, std::int64_t now_ns) {
  if (newcomers_.size() >= limits_.pending_max) {
    return refusal(protocol::Refusal::kRateLimited,
                   std::to_string(newcomers_.size()) + " connections without a hello, of at most " +
                       std::to_string(limits_.pending_max));
  }
  Newcomer& newcomer = newcomers_[id];
  newcomer.address = address;
  newcomer.deadline_ns = now_ns + limits_.deadline_ns;
  return {};
}

Verdict HelloGate::hear(NewcomerId id, std::span<const std::byte> bytes) {
  const auto found = newcomers_.find(id);
  if (found == newcomers_.end()) return {};
  Newcomer& newcomer = found->second;
  (void)newcomer.framer.feed(bytes);
  const auto payload = newcomer.framer.next();
  Verdict verdict;
  if (!payload) {
    if (!newcomer.framer.broken()) return verdict;
    const std::uint32_t announced = newcomer.framer.announced_bytes();
    verdict =
        refusal(announced == 0 ? protocol::Refusal::kBadMessage : protocol::Refusal::kTooLarge,
                "a message of " + std::to_string(announced) + " bytes, of 1 to " +
                    std::to_string(protocol::kHelloBytesMax));
    newcomers_.erase(found);
    return verdict;
  }
  auto decoded = protocol::decode_client(*payload);
  if (!decoded.message) {
    verdict = refusal(protocol::Refusal::kBadMessage, "not a message: " + decoded.error);
  } else if (auto* hello = std::get_if<protocol::Hello>(&*decoded.message); hello == nullptr) {
    verdict = refusal(protocol::Refusal::kBadMessage, "the first message is not a hello");
  } else {
    verdict.kind = Verdict::Kind::kAdmit;
    verdict.admission.hello = std::move(*hello);
    verdict.admission.address = newcomer.address;
    // What is behind the hello came in the last piece: with an earlier one it was not whole.
    const std::size_t behind = newcomer.framer.held_bytes();
    const auto rest = bytes.last(behind);
    verdict.rest.assign(rest.begin(), rest.end());
  }
  newcomers_.erase(found);
  return verdict;
}

std::vector<std::pair<NewcomerId, protocol::Refused>> HelloGate::overdue(std::int64_t now_ns) {
  std::vector<std::pair<NewcomerId, protocol::Refused>> late;
  while (!newcomers_.empty() && newcomers_.begin()->second.deadline_ns <= now_ns) {
    late.emplace_back(
        newcomers_.begin()->first,
        protocol::Refused{
            protocol::Refusal::kTooSlow,
            "no hello within " + std::to_string(limits_.deadline_ns / 1'000'000) + " ms"});
    newcomers_.erase(newcomers_.begin());
  }
  return late;
}

}  // namespace cycloid::server
