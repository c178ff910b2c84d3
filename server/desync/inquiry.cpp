#include "server/desync/inquiry.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::server {
namespace {

constexpr std::int64_t kHourNs = 3'600'000'000'000;
/// Ticks whose votes are kept, and replicas that may vote: far beyond what a room has.
constexpr std::size_t kVoteTicksKept = 8;
constexpr std::size_t kVotersMax = 4096;
/// Inputs that a report shows on each side of its tick.
constexpr std::uint64_t kTicksAround = 8;

}  // namespace

void DesyncDesk::start(const scenes::Simulation& simulation) {
  history_.start(simulation);
  votes_.clear();
  for (auto& [peer, inquiry] : inquiries_)
    if (inquiry.stage != Stage::kDone) give_up(inquiry, "the match was taken back meanwhile");
}

void DesyncDesk::on_tick(const protocol::InputFrame& frame, std::uint64_t digest,
                         const scenes::Simulation& simulation) {
  if (frame.tick != history_.last_tick() + 1) return start(simulation);
  history_.add(frame, digest, simulation);
}

void DesyncDesk::on_digest(PeerId peer, std::uint64_t tick, std::uint64_t digest) {
  if (!history_.digest(tick)) return;
  auto& voters = votes_[tick];
  if (voters.size() < kVotersMax) voters.try_emplace(peer, digest);
  if (votes_.size() > kVoteTicksKept) votes_.erase(votes_.begin());
}

ReplicaVotes DesyncDesk::votes(std::uint64_t tick) const {
  ReplicaVotes votes;
  const auto voters = votes_.find(tick);
  const auto mine = history_.digest(tick);
  if (voters == votes_.end() || !mine) return votes;
  std::map<std::uint64_t, std::uint32_t> counts;
  for (const auto& [peer, digest] : voters->second) ++counts[digest];
  votes.replicas = static_cast<std::uint32_t>(voters->second.size());
  for (const auto& [digest, count] : counts) {
    if (digest == *mine) {
      votes.with_server = count;
    } else if (count > votes.largest_other) {
      votes.largest_other = count;
      votes.other_digest = digest;
    }
  }
  return votes;
}

bool DesyncDesk::within_rate(std::int64_t now_ns) {
  if (now_ns - hour_begin_ns_ >= kHourNs || hour_begin_ns_ == 0) {
    hour_begin_ns_ = now_ns;
    hour_findings_ = 0;
  }
  if (hour_findings_ >= options_.findings_per_hour) return false;
  ++hour_findings_;
  return true;
}

bool DesyncDesk::on_mismatch(const ClientIdentity& client, const protocol::Digest& said,
                             std::int64_t now_ns) {
  const auto mine = history_.digest(said.tick);
  if (!mine || *mine == said.digest) return false;
  if (inquiries_.contains(client.peer)) return false;
  if (inquiries_.size() >= options_.inquiries_max || !within_rate(now_ns)) {
    ++counts_.skipped;
    return false;
  }
  ++counts_.opened;
  Inquiry& inquiry = inquiries_[client.peer];
  inquiry.opened_ns = now_ns;
  inquiry.finding.room = room_;
  inquiry.finding.client = client;
  inquiry.finding.noticed_tick = said.tick;
  inquiry.finding.votes = votes(said.tick);
  inquiry.finding.server_digest = *mine;
  inquiry.finding.client_digest = said.digest;
  capture(said.tick, inquiry.finding);
  return true;
}

/// At once, because what is kept moves on while the client answers.
void DesyncDesk::capture(std::uint64_t tick, Finding& finding) const {
  finding.tick = tick;
  finding.start = history_.before(tick);
  finding.later = history_.from(tick);
  const std::uint64_t last = std::max(tick, finding.noticed_tick) + kTicksAround;
  const std::uint64_t first = tick > kTicksAround ? tick - kTicksAround : 1;
  finding.ticks =
      history_.ticks(finding.start ? std::min(finding.start->tick, first) : first, last);
}

DesyncDesk::Inquiry* DesyncDesk::asked(PeerId peer, Stage stage) {
  const auto found = inquiries_.find(peer);
  if (found != inquiries_.end() && found->second.stage == stage) return &found->second;
  ++counts_.unasked;
  return nullptr;
}

void DesyncDesk::give_up(Inquiry& inquiry, std::string why) {
  inquiry.stage = Stage::kDone;
  inquiry.finding.client_state = {};
  inquiry.finding.missing = std::move(why);
}

std::optional<protocol::StateWanted> DesyncDesk::on_tick_digests(
    PeerId peer, const protocol::TickDigests& digests) {
  Inquiry* inquiry = asked(peer, Stage::kDigests);
  if (inquiry == nullptr) return std::nullopt;
  const std::uint64_t last = inquiry->finding.noticed_tick;
  const bool follows = inquiry->next_tick == 0 || digests.first_tick == inquiry->next_tick;
  if (digests.digests.empty() || !follows || digests.first_tick > last ||
      digests.digests.size() > last - digests.first_tick + 1) {
    give_up(*inquiry, "it sent digests of ticks that it was not asked for");
    return std::nullopt;
  }
  for (std::size_t i = 0; i < digests.digests.size(); ++i) {
    const std::uint64_t tick = digests.first_tick + i;
    const auto mine = history_.digest(tick);
    if (!mine) continue;
    if (*mine != digests.digests[i]) {
      differs_at(tick, *mine, digests.digests[i], *inquiry);
      return protocol::StateWanted{tick};
    }
    inquiry->equal_tick = tick;
  }
  inquiry->next_tick = digests.first_tick + digests.digests.size();
  if (inquiry->next_tick > last) give_up(*inquiry, "none of the digests that it sent differs");
  return std::nullopt;
}

void DesyncDesk::differs_at(std::uint64_t tick, std::uint64_t mine, std::uint64_t theirs,
                            Inquiry& inquiry) {
  inquiry.stage = Stage::kState;
  inquiry.finding.is_first = tick == 1 || (inquiry.equal_tick && *inquiry.equal_tick + 1 == tick);
  inquiry.finding.server_digest = mine;
  inquiry.finding.client_digest = theirs;
  capture(tick, inquiry.finding);
}

void DesyncDesk::on_state_part(PeerId peer, const protocol::StatePart& part) {
  Inquiry* inquiry = asked(peer, Stage::kState);
  if (inquiry == nullptr) return;
  std::vector<std::byte>& state = inquiry->finding.client_state;
  const std::size_t most = 2 * history_.newest_bytes() + options_.state_slack_bytes;
  if (part.tick != inquiry->finding.tick)
    return give_up(*inquiry, "it sent its state of tick " + std::to_string(part.tick));
  if (part.total_bytes == 0 || part.total_bytes > most) {
    return give_up(*inquiry, "its state has " + std::to_string(part.total_bytes) +
                                 " bytes, of 1 to " + std::to_string(most));
  }
  if (state.empty()) inquiry->total_bytes = part.total_bytes;
  if (part.total_bytes != inquiry->total_bytes || part.offset != state.size() ||
      part.bytes.empty() || part.bytes.size() > part.total_bytes - state.size()) {
    return give_up(*inquiry, "its state came out of order: " + std::to_string(part.bytes.size()) +
                                 " bytes at " + std::to_string(part.offset) + " of " +
                                 std::to_string(part.total_bytes) + ", after " +
                                 std::to_string(state.size()));
  }
  state.insert(state.end(), part.bytes.begin(), part.bytes.end());
  if (state.size() == inquiry->total_bytes) inquiry->stage = Stage::kDone;
}

void DesyncDesk::on_leave(PeerId peer) {
  const auto found = inquiries_.find(peer);
  if (found == inquiries_.end() || found->second.stage == Stage::kDone) return;
  give_up(found->second, "it left before it had sent its state");
}

std::vector<Finding> DesyncDesk::take_findings(std::int64_t now_ns, std::size_t replicas) {
  std::vector<Finding> findings;
  for (auto at = inquiries_.begin(); at != inquiries_.end();) {
    Inquiry& inquiry = at->second;
    const std::int64_t open_ns = now_ns - inquiry.opened_ns;
    if (inquiry.stage != Stage::kDone && open_ns >= options_.deadline.count()) {
      give_up(inquiry, inquiry.stage == Stage::kDigests ? "it did not say which ticks differ"
                                                        : "it did not send its state in time");
    }
    const ReplicaVotes now = votes(inquiry.finding.noticed_tick);
    if (now.replicas >= inquiry.finding.votes.replicas) inquiry.finding.votes = now;
    const bool counted = inquiry.finding.votes.replicas >= replicas;
    const bool around = history_.digest(inquiry.finding.tick + kTicksAround).has_value();
    const bool waits = !(counted && around) && open_ns < options_.votes_wait.count();
    if (inquiry.stage != Stage::kDone || waits) {
      ++at;
      continue;
    }
    findings.push_back(finish(inquiry));
    at = inquiries_.erase(at);
  }
  return findings;
}

/// Adds what has been made since the finding was captured.
Finding DesyncDesk::finish(Inquiry& inquiry) {
  Finding finding = std::move(inquiry.finding);
  if (!finding.later) finding.later = history_.from(finding.tick);
  if (!finding.ticks.empty()) {
    const std::uint64_t last = std::max(finding.tick, finding.noticed_tick) + kTicksAround;
    const std::uint64_t next = finding.ticks.back().frame.tick + 1;
    for (protocol::LogTick& tick : history_.ticks(next, last))
      if (tick.frame.tick == finding.ticks.back().frame.tick + 1)
        finding.ticks.push_back(std::move(tick));
  }
  ++(finding.missing.empty() ? counts_.complete : counts_.without);
  return finding;
}

std::size_t DesyncDesk::held_bytes() const {
  std::size_t bytes = 0;
  for (const auto& [peer, inquiry] : inquiries_) bytes += inquiry.finding.client_state.size();
  return bytes;
}

}  // namespace cycloid::server
