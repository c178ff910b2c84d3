#include "server/admission/gate.hpp"

#include <algorithm>
#include <utility>

#include "server/room/wrong_size.hpp"

namespace cycloid::server {
namespace {

using protocol::Refusal;

std::string seat_text(std::int32_t seat) {
  if (seat == protocol::kAnySeat) return "any seat";
  if (seat == protocol::kSpectator) return "no seat";
  return "seat " + std::to_string(seat);
}

/// Whether the token lets its bearer have what the hello wishes: "" or what does not match.
std::string scope_mismatch(const protocol::Hello& hello, const AdmissionToken& token) {
  if (!hello.room.empty() && hello.room != token.room)
    return "room \"" + hello.room + "\" is wished, the token is for \"" + token.room + "\"";
  const std::int32_t wish = hello.seat_wish;
  if (token.role == Role::kSpectator && wish >= 0)
    return seat_text(wish) + " is wished, the token is for a spectator";
  if (token.seat != protocol::kAnySeat && wish != protocol::kAnySeat && wish != token.seat)
    return seat_text(wish) + " is wished, the token is for " + seat_text(token.seat);
  return "";
}

Refusal code_of(RoomFound found) {
  switch (found) {
    case RoomFound::kLocked:
      return Refusal::kRoomLocked;
    case RoomFound::kFull:
      return Refusal::kRoomFull;
    case RoomFound::kDraining:
      return Refusal::kDraining;
    default:
      return Refusal::kNoSuchRoom;
  }
}

std::string words_of(RoomFound found, const std::string& room) {
  const std::string name = room.empty() ? "the room" : "room \"" + room + "\"";
  switch (found) {
    case RoomFound::kLocked:
      return name + " is locked";
    case RoomFound::kFull:
      return name + " is full";
    case RoomFound::kDraining:
      return name + " takes nobody in any more";
    default:
      return room.empty() ? "no room is named, and there is not only one"
                          : "there is no room \"" + room + "\"";
  }
}

/// Feeds what belongs to the first message and takes it off `bytes`: first the size, then as much
/// as it says.
void feed_first(protocol::Framer& framer, std::span<const std::byte>& bytes) {
  constexpr std::size_t kPrefix = protocol::Framer::kPrefixBytes;
  const auto feed = [&](std::size_t wanted_bytes) {
    const std::size_t count = std::min(bytes.size(), wanted_bytes);
    (void)framer.feed(bytes.first(count));
    bytes = bytes.subspan(count);
  };
  if (framer.held_bytes() < kPrefix) feed(kPrefix - framer.held_bytes());
  if (framer.broken() || framer.held_bytes() < kPrefix) return;
  feed(kPrefix + framer.announced_bytes() - framer.held_bytes());
}

}  // namespace

Gate::Gate(GateOptions options, FindRoom find_room)
    : options_(std::move(options)),
      find_room_(std::move(find_room)),
      verifier_(options_.keys, options_.leeway_s),
      nonces_(options_.nonces_max),
      addresses_(options_.addresses) {}

void Gate::set_limits(const GateOptions& limits) {
  options_.connections_max = limits.connections_max;
  options_.pending_max = limits.pending_max;
  addresses_.set_limits(limits.addresses);
}

std::string Gate::full(const PeerAddress& address, std::int64_t now_ns) {
  if (open_.size() >= options_.connections_max)
    return std::to_string(options_.connections_max) + " connections are open, no more may be";
  if (pending() >= options_.pending_max)
    return std::to_string(options_.pending_max) + " connections wait for their hello already";
  return addresses_.open(address, now_ns);
}

std::string Gate::too_slow() const {
  return "no hello within " + std::to_string(options_.hello_deadline_ns / 1'000'000) + " ms";
}

std::variant<GateId, GateRefused> Gate::begin(const PeerAddress& address, std::int64_t now_ns) {
  if (draining_) return refuse(Refusal::kDraining, *draining_);
  const std::string reason = full(address, now_ns);
  if (!reason.empty()) return refuse(Refusal::kRateLimited, reason);
  const GateId id = next_id_++;
  open_.emplace(id, Open{address, State::kPending});
  pending_[id].deadline_ns = now_ns + options_.hello_deadline_ns;
  ++counts_.begun;
  return id;
}

GateResult Gate::feed(GateId id, std::span<const std::byte> bytes, const GateTime& now) {
  const auto found = pending_.find(id);
  if (found == pending_.end())
    return refuse(Refusal::kBadMessage, "the connection has its answer already");
  if (now.now_ns >= found->second.deadline_ns)
    return refuse_open(id, Refusal::kTooSlow, too_slow());
  protocol::Framer& framer = found->second.framer;
  feed_first(framer, bytes);
  const auto payload = framer.next();
  if (framer.broken()) {
    const auto [code, reason] = wrong_size(framer.announced_bytes(), protocol::kHelloBytesMax);
    return refuse_open(id, code, reason);
  }
  if (!payload) return GateWaiting{};
  const auto decoded = protocol::decode_client(*payload);
  if (!decoded.message)
    return refuse_open(id, Refusal::kBadMessage, "not a message: " + decoded.error);
  const auto* hello = std::get_if<protocol::Hello>(&*decoded.message);
  if (hello == nullptr)
    return refuse_open(id, Refusal::kBadMessage, "the first message is not a hello");
  Open& open = open_.at(id);
  auto judged = judge(*hello, open.address, now);
  if (const auto* fault = std::get_if<Fault>(&judged))
    return refuse_open(id, fault->code, fault->reason);
  open.state = State::kAdmitted;
  addresses_.settle(open.address);
  pending_.erase(id);
  ++counts_.admitted;
  return GateAdmitted{std::get<Admission>(std::move(judged)), {bytes.begin(), bytes.end()}};
}

std::variant<Admission, Gate::Fault> Gate::judge(const protocol::Hello& hello,
                                                 const PeerAddress& address, const GateTime& now) {
  if (hello.protocol_version != protocol::kProtocolVersion) {
    return Fault{Refusal::kProtocolVersion, "protocol version " +
                                                std::to_string(hello.protocol_version) + ", here " +
                                                std::to_string(protocol::kProtocolVersion)};
  }
  if (draining_) return Fault{Refusal::kDraining, *draining_};
  Admission admission;
  admission.hello = hello;
  admission.address = address.text();
  if (hello.seat_wish == protocol::kSpectator) admission.role = Role::kSpectator;
  std::optional<AdmissionToken> token;
  if (auto fault = check_token(now, admission, token)) return *fault;
  if (auto fault = check_room(admission)) return *fault;
  // Only now: a token that was refused because the room was full is still good for another try.
  if (token)
    (void)nonces_.use(token->nonce, token->expires_unix_s + verifier_.leeway_s(), now.unix_s);
  return admission;
}

std::optional<Gate::Fault> Gate::check_token(const GateTime& now, Admission& admission,
                                             std::optional<AdmissionToken>& token) {
  const protocol::Hello& hello = admission.hello;
  if (options_.tokens == TokenPolicy::kIgnored) return {};
  // Who resumes shows the room's own secret instead; the room knows it or refuses.
  const bool none_needed = options_.tokens == TokenPolicy::kOptional || !hello.resume.empty();
  if (hello.token.empty() && none_needed) return {};
  auto verified = verifier_.verify(hello.token, now.unix_s);
  if (const auto* fault = std::get_if<TokenFault>(&verified))
    return Fault{fault->code, fault->reason};
  token = std::get<AdmissionToken>(std::move(verified));
  const std::string mismatch = scope_mismatch(hello, *token);
  if (!mismatch.empty()) return Fault{Refusal::kTokenScope, mismatch};
  const std::int64_t forget_at_unix_s = token->expires_unix_s + verifier_.leeway_s();
  switch (nonces_.check(token->nonce, forget_at_unix_s, now.unix_s)) {
    case NonceStore::Answer::kUsed:
      return Fault{Refusal::kTokenUsed, "the token was used before; each is good once"};
    case NonceStore::Answer::kFull:
      return Fault{Refusal::kRateLimited,
                   std::to_string(options_.nonces_max) +
                       " used tokens have not expired yet, no more can be remembered"};
    case NonceStore::Answer::kFresh:
      break;
  }
  admission.identity = token->identity;
  admission.hello.room = token->room;
  admission.seat = token->seat;
  if (token->role == Role::kSpectator) admission.seat = protocol::kSpectator;
  // Somebody who may play may also watch.
  if (token->role != Role::kPlayer || admission.role == Role::kPlayer) admission.role = token->role;
  return {};
}

void Gate::give_back_token(const Admission& admission) {
  if (options_.tokens == TokenPolicy::kIgnored || admission.hello.token.empty()) return;
  // It was verified when it was used; since then its key may have been taken away.
  const auto read = read_unverified(admission.hello.token);
  if (const auto* used = std::get_if<UnverifiedToken>(&read)) nonces_.give_back(used->token.nonce);
}

std::optional<Gate::Fault> Gate::check_room(const Admission& admission) {
  const std::string& room = admission.hello.room;
  const RoomVerdict verdict = find_room_(room, admission);
  if (verdict.found == RoomFound::kExists || verdict.found == RoomFound::kCreated) return {};
  return Fault{code_of(verdict.found),
               verdict.reason.empty() ? words_of(verdict.found, room) : verdict.reason};
}

GateRefused Gate::refuse(Refusal code, const std::string& reason) {
  ++counts_.refused[static_cast<std::size_t>(code)];
  return {code, reason, protocol::encode(protocol::ServerMessage(protocol::Refused{code, reason}))};
}

GateRefused Gate::refuse_open(GateId id, Refusal code, const std::string& reason) {
  pending_.erase(id);
  open_.at(id).state = State::kRefused;
  ++refused_;
  return refuse(code, reason);
}

std::vector<GateOverdue> Gate::overdue(std::int64_t now_ns) {
  std::vector<GateOverdue> over;
  while (!pending_.empty() && pending_.begin()->second.deadline_ns <= now_ns) {
    const GateId id = pending_.begin()->first;
    over.push_back({id, refuse_open(id, Refusal::kTooSlow, too_slow())});
  }
  return over;
}

std::optional<std::int64_t> Gate::next_deadline_ns() const {
  if (pending_.empty()) return {};
  return pending_.begin()->second.deadline_ns;
}

void Gate::end(GateId id) {
  const auto found = open_.find(id);
  if (found == open_.end()) return;
  if (found->second.state == State::kRefused) --refused_;
  addresses_.close(found->second.address, found->second.state != State::kAdmitted);
  open_.erase(found);
  pending_.erase(id);
}

std::size_t Gate::held_bytes() const {
  std::size_t bytes = 0;
  for (const auto& [id, pending] : pending_) bytes += pending.framer.held_bytes();
  return bytes;
}

}  // namespace cycloid::server
