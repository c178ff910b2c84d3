#include <algorithm>
#include <set>
#include <variant>

#include "server/admission/gate.hpp"
#include "tests/fuzz/targets.hpp"

namespace cycloid::fuzz {
namespace {

using server::AdmissionToken;
using server::Gate;
using server::GateId;

constexpr std::int64_t kNow_s = 1'800'000'000;

/// The same in every run.
server::RandomSource counting_random(unsigned first) {
  return [first](std::span<std::byte> bytes) mutable {
    for (std::byte& each : bytes) each = static_cast<std::byte>(first++);
  };
}

const server::SigningKey& fuzz_key() {
  static const server::SigningKey kKey = server::SigningKey::generate(counting_random(1));
  return kKey;
}

AdmissionToken good_token(unsigned number) {
  AdmissionToken token;
  token.room = "arena";
  token.identity = "ada";
  token.not_before_unix_s = kNow_s - 10;
  token.expires_unix_s = kNow_s + 60;
  counting_random(number)(token.nonce);
  return token;
}

/// What a verifier takes is what an issuer has made, to the byte.
void check_token(const std::vector<std::byte>& bytes) {
  const server::TokenVerifier verifier({fuzz_key().public_key()});
  const auto verified = verifier.verify(bytes, kNow_s);
  if (const auto* fault = std::get_if<server::TokenFault>(&verified)) {
    const bool known = fault->code == protocol::Refusal::kTokenInvalid ||
                       fault->code == protocol::Refusal::kTokenExpired;
    if (!known || fault->reason.empty()) fail("a token is refused without a reason");
    return;
  }
  const auto& token = std::get<AdmissionToken>(verified);
  if (!server::mistake_of(token).empty()) fail("a token out of bounds is taken");
  if (server::sign_token(token, fuzz_key()) != bytes) fail("a token has two encodings");
}

}  // namespace

void run_token(Input input) {
  const unsigned mode = mode_of(input);
  const auto text =
      server::parse_token_text({reinterpret_cast<const char*>(input.data()), input.size()});
  if (text && server::parse_token_text(server::token_text(*text)) != *text)
    fail("the text of a token is another one");
  if (mode % 2 == kRawMode) {
    check_token({input.begin(), input.end()});
    return;
  }
  const std::vector<std::byte> good = server::sign_token(good_token(mode), fuzz_key());
  const Seed body(good.begin() + server::kSignatureBytes, good.end());
  // Signed after the edits: so they get behind the signature.
  check_token(server::sign_token_bytes(edited(body, input), fuzz_key()));
}

std::vector<Seed> token_seeds() {
  return {with_mode(kRawMode, server::sign_token(good_token(1), fuzz_key())),
          with_mode(kEditMode, std::vector<std::byte>(8, std::byte{0})),
          with_mode(kEditMode, std::vector<std::byte>(16, std::byte{1}))};
}

namespace {

constexpr std::size_t kPendingMax = 6;
constexpr std::size_t kConnectionsMax = 9;

server::GateOptions small_gate() {
  server::GateOptions options;
  options.tokens = server::TokenPolicy::kRequired;
  options.keys = {fuzz_key().public_key()};
  options.nonces_max = 8;
  options.hello_deadline_ns = 1000;
  options.pending_max = kPendingMax;
  options.connections_max = kConnectionsMax;
  options.addresses.host_connections_max = 4;
  options.addresses.entries_max = 16;
  options.addresses.host_connects = {1'000'000, 4};
  return options;
}

/// Many connections at one gate, as a script of two bytes for each act says.
class GatePlay {
 public:
  void act(unsigned what, unsigned how) {
    switch (what % 8) {
      case 0:
        begin(how);
        break;
      case 1:
      case 2:
        feed(how, 1 + how / 8);
        break;
      case 3:
        feed(how, 5000);
        break;
      case 4:
        spoilt_ ^= how;
        break;
      case 5:
        now_.now_ns += how;
        for (const server::GateOverdue& each : gate_.overdue(now_.now_ns)) answered(each.id);
        break;
      case 6:
        end(how);
        break;
      default:
        verdict_.found = static_cast<server::RoomFound>(how % 6);
        now_.unix_s += how / 64;
        if (how == 255) gate_.drain("over");
    }
    check();
  }

 private:
  struct Line {
    GateId id = 0;
    protocol::Bytes stream;  ///< A hello and something behind it.
    std::size_t said = 0;
    bool answered = false;
  };

  void begin(unsigned how) {
    const auto begun = gate_.begin(
        server::PeerAddress::v4({10, static_cast<std::uint8_t>(how % 4), 0, 1}), now_.now_ns);
    const auto* id = std::get_if<GateId>(&begun);
    if (id == nullptr) return;
    protocol::Hello hello;
    hello.token = server::sign_token(good_token(how % 32), fuzz_key());
    protocol::Bytes stream = protocol::encode(protocol::ClientMessage(hello));
    stream.resize(stream.size() + 9);
    lines_.push_back({*id, stream, 0, false});
  }

  Line* line_of(unsigned how) { return lines_.empty() ? nullptr : &lines_[how % lines_.size()]; }

  void feed(unsigned how, std::size_t count) {
    Line* const line = line_of(how);
    if (line == nullptr) return;
    protocol::Bytes bytes(line->stream.begin() + static_cast<std::ptrdiff_t>(line->said),
                          line->stream.end());
    bytes.resize(std::min(count, bytes.size()));
    line->said += bytes.size();
    const bool spoils = how % 16 == 5 && !bytes.empty();
    if (spoils) bytes[spoilt_ % bytes.size()] ^= static_cast<std::byte>(1u << (spoilt_ / 256 % 8));
    const auto result = gate_.feed(line->id, bytes, now_);
    const bool waits = std::holds_alternative<server::GateWaiting>(result);
    if (line->answered && !std::holds_alternative<server::GateRefused>(result))
      fail("a connection has two answers");
    if (!waits && !line->answered) answered(line->id);
    if (const auto* admitted = std::get_if<server::GateAdmitted>(&result)) check_in(*admitted);
  }

  void check_in(const server::GateAdmitted& admitted) {
    const auto verified = server::TokenVerifier({fuzz_key().public_key()})
                              .verify(admitted.admission.hello.token, now_.unix_s);
    const auto* token = std::get_if<AdmissionToken>(&verified);
    if (token == nullptr) fail("somebody came in without a good token");
    if (!used_.insert(token->nonce).second) fail("a token was used twice");
    if (admitted.admission.hello.room != "arena") fail("a room that the token does not name");
    if (admitted.rest.size() > 9) fail("more behind the hello than was said");
  }

  void answered(GateId id) {
    for (Line& line : lines_) {
      if (line.id != id) continue;
      if (line.answered) fail("a connection is answered twice");
      line.answered = true;
    }
  }

  void end(unsigned how) {
    Line* const line = line_of(how);
    if (line == nullptr) return;
    gate_.end(line->id);
    lines_.erase(lines_.begin() + (line - lines_.data()));
  }

  void check() const {
    if (gate_.pending() > kPendingMax) fail("too many wait in the gate");
    if (gate_.connections() > kConnectionsMax) fail("too many connections");
    if (gate_.connections() != lines_.size()) fail("the gate has lost count");
    if (gate_.held_bytes() > kPendingMax * (protocol::kHelloBytesMax + 4))
      fail("the gate holds more than a hello for each");
  }

  server::GateTime now_{0, kNow_s};
  server::RoomVerdict verdict_;
  unsigned spoilt_ = 0;
  std::vector<Line> lines_;
  std::set<server::TokenNonce> used_;
  Gate gate_{small_gate(), [this](const std::string& room, const server::Admission& admission) {
               if (room != "arena" || admission.identity != "ada") fail("asked for nobody's room");
               return verdict_;
             }};
};

}  // namespace

void run_gate(Input input) {
  GatePlay play;
  for (; input.size() >= 2; input = input.subspan(2))
    play.act(static_cast<unsigned>(input[0]), static_cast<unsigned>(input[1]));
}

std::vector<Seed> gate_seeds() {
  const auto script = [](const std::vector<unsigned>& acts) {
    Seed seed;
    for (const unsigned act : acts) seed.push_back(static_cast<std::byte>(act));
    return seed;
  };
  return {script({0, 1, 0, 2, 3, 0, 3, 1, 6, 0, 0, 1, 3, 1}),
          script({0, 1, 1, 255, 1, 255, 1, 255, 1, 255, 1, 255, 1, 255, 1, 255, 5, 99, 3, 0}),
          script({0, 3, 4, 77, 3, 5, 0, 4, 0, 5, 5, 255, 5, 255, 5, 255, 5, 255, 5, 255}),
          script({7, 3, 0, 1, 3, 0, 7, 0, 0, 1, 3, 1, 7, 255, 0, 1})};
}

}  // namespace cycloid::fuzz
