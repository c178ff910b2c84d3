#include "server/desync/inquiry.hpp"

#include <algorithm>
#include <utility>

#include "server/desync/report.hpp"

namespace cycloid::server {
namespace {

constexpr std::int64_t kHourNs = 3'600'000'000'000;
/// Ticks whose votes are kept, and replicas that may vote: far beyond what a room has.
constexpr std::size_t kVoteTicksKept = 8;
constexpr std::size_t kVotersMax = 4096;

std::optional<KeptState> kept(const std::shared_ptr<const ExactState>& state) {
  if (state == nullptr) return std::nullopt;
  return KeptState{state->tick(), state->digest(), {state, &state->bytes()}};
}

/// Of the ticks first, ..., last, as far as they are kept.
std::vector<protocol::LogTick> kept_ticks(const RoomEvidence& evidence, std::uint64_t first,
                                          std::uint64_t last) {
  std::vector<protocol::LogTick> found;
  for (std::uint64_t tick = first; tick <= last; ++tick) {
    const protocol::InputFrame* frame = evidence.frame_at(tick);
    if (frame != nullptr) found.push_back({*frame, *evidence.digest_at(tick)});
  }
  return found;
}

/// At once, because what is kept moves on while the client answers.
void capture(std::uint64_t tick, const RoomEvidence& evidence, Finding& finding) {
  finding.tick = tick;
  finding.start = tick == 0 ? std::nullopt : kept(evidence.state_at_or_before(tick - 1));
  finding.later = kept(evidence.state_from(tick));
  const std::uint64_t last = std::max(tick, finding.noticed_tick) + kReportInputTicks;
  const std::uint64_t first = tick > kReportInputTicks ? tick - kReportInputTicks : 1;
  finding.ticks =
      kept_ticks(evidence, finding.start ? std::min(finding.start->tick, first) : first, last);
}

}  // namespace

void DesyncDesk::on_digest(PeerId peer, std::uint64_t tick, std::uint64_t digest) {
  auto& voters = votes_[tick];
  if (voters.size() < kVotersMax) voters.try_emplace(peer, digest);
  if (votes_.size() > kVoteTicksKept) votes_.erase(votes_.begin());
}

ReplicaVotes DesyncDesk::votes(std::uint64_t tick, const RoomEvidence& evidence) const {
  ReplicaVotes votes;
  const auto voters = votes_.find(tick);
  const auto mine = evidence.digest_at(tick);
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
                             std::int64_t now_ns, const RoomEvidence& evidence) {
  const auto mine = evidence.digest_at(said.tick);
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
  inquiry.finding.votes = votes(said.tick, evidence);
  inquiry.finding.server_digest = *mine;
  inquiry.finding.client_digest = said.digest;
  capture(said.tick, evidence, inquiry.finding);
  return true;
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
    PeerId peer, const protocol::TickDigests& digests, const RoomEvidence& evidence) {
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
    const auto mine = evidence.digest_at(tick);
    if (!mine) continue;
    if (*mine != digests.digests[i]) {
      differs_at({tick, digests.digests[i]}, *mine, evidence, *inquiry);
      return protocol::StateWanted{tick};
    }
    inquiry->equal_tick = tick;
  }
  inquiry->next_tick = digests.first_tick + digests.digests.size();
  if (inquiry->next_tick > last) give_up(*inquiry, "none of the digests that it sent differs");
  return std::nullopt;
}

void DesyncDesk::differs_at(const protocol::Digest& said, std::uint64_t mine,
                            const RoomEvidence& evidence, Inquiry& inquiry) {
  const std::uint64_t tick = said.tick;
  inquiry.stage = Stage::kState;
  inquiry.finding.is_first = tick == 1 || (inquiry.equal_tick && *inquiry.equal_tick + 1 == tick);
  inquiry.finding.server_digest = mine;
  inquiry.finding.client_digest = said.digest;
  capture(tick, evidence, inquiry.finding);
}

void DesyncDesk::on_state_part(PeerId peer, const protocol::StatePart& part,
                               const RoomEvidence& evidence) {
  Inquiry* inquiry = asked(peer, Stage::kState);
  if (inquiry == nullptr) return;
  std::vector<std::byte>& state = inquiry->finding.client_state;
  const auto newest = evidence.state_at_or_before(evidence.tick());
  const std::size_t newest_bytes = newest == nullptr ? 0 : newest->bytes().size();
  const std::size_t most = 2 * newest_bytes + options_.state_slack_bytes;
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

std::vector<Finding> DesyncDesk::take_findings(std::int64_t now_ns, const RoomEvidence& evidence) {
  std::vector<Finding> findings;
  for (auto at = inquiries_.begin(); at != inquiries_.end();) {
    Inquiry& inquiry = at->second;
    const std::int64_t open_ns = now_ns - inquiry.opened_ns;
    if (inquiry.stage != Stage::kDone && open_ns >= options_.deadline.count()) {
      give_up(inquiry, inquiry.stage == Stage::kDigests ? "it did not say which ticks differ"
                                                        : "it did not send its state in time");
    }
    recount(inquiry, evidence);
    if (inquiry.stage != Stage::kDone || open_ns < options_.votes_wait.count()) {
      ++at;
      continue;
    }
    findings.push_back(finish(inquiry, evidence));
    at = inquiries_.erase(at);
  }
  return findings;
}

std::vector<Finding> DesyncDesk::close(const std::string& why, const RoomEvidence& evidence) {
  std::vector<Finding> findings;
  for (auto& [peer, inquiry] : inquiries_) {
    if (inquiry.stage != Stage::kDone) give_up(inquiry, why);
    recount(inquiry, evidence);
    findings.push_back(finish(inquiry, evidence));
  }
  inquiries_.clear();
  votes_.clear();
  return findings;
}

/// Votes are forgotten sooner than an inquiry may last, so the fullest count stands.
void DesyncDesk::recount(Inquiry& inquiry, const RoomEvidence& evidence) const {
  const ReplicaVotes now = votes(inquiry.finding.noticed_tick, evidence);
  if (now.replicas >= inquiry.finding.votes.replicas) inquiry.finding.votes = now;
}

/// Adds what has been made since the finding was captured.
Finding DesyncDesk::finish(Inquiry& inquiry, const RoomEvidence& evidence) {
  Finding finding = std::move(inquiry.finding);
  if (!finding.later) finding.later = kept(evidence.state_from(finding.tick));
  if (!finding.ticks.empty()) {
    const std::uint64_t last = std::max(finding.tick, finding.noticed_tick) + kReportInputTicks;
    const std::uint64_t next = finding.ticks.back().frame.tick + 1;
    for (protocol::LogTick& tick : kept_ticks(evidence, next, last)) {
      if (tick.frame.tick == finding.ticks.back().frame.tick + 1)
        finding.ticks.push_back(std::move(tick));
    }
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
