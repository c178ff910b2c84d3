#include "cli/sim/hostile.hpp"

#include <algorithm>

#include "scenes/catalogue.hpp"

namespace cycloid::sim {
namespace {

constexpr std::uint64_t kStrangerWays = 14;
constexpr std::uint64_t kTroubles = 8;
constexpr std::int64_t kDripNs = 100 * kMillisecond;

}  // namespace

Hostile::Hostile(const Settings& settings, const scenes::Scene& scene, Kind kind, std::size_t room,
                 Random random, Host& host, Chronicle& chronicle)
    : settings_(&settings),
      kind_(kind),
      room_(room),
      random_(random),
      host_(&host),
      chronicle_(&chronicle),
      scene_digest_(scenes::scene_digest(scene)) {
  dial_at_ns_ = random_.between(0, 2 * kSecond);
}

void Hostile::step() {
  const std::int64_t now = chronicle_->now_ns;
  if (calm_) return;
  if (!wire_ && now >= dial_at_ns_) dial();
  if (!wire_) return;
  wire_->step(*chronicle_);
  if (reads_) (void)wire_->down.read(16384);
  if (kind_ == Kind::kTroublemaker && now >= next_ns_) make_trouble();
  if (!unsent_.empty() && (drip_bytes_ == 0 || now >= next_ns_)) {
    const std::size_t most =
        drip_bytes_ == 0 ? unsent_.size() : std::min(drip_bytes_, unsent_.size());
    const std::size_t sent = wire_->up.write(std::span<const std::byte>(unsent_).first(most));
    unsent_.erase(unsent_.begin(), unsent_.begin() + static_cast<std::ptrdiff_t>(sent));
    if (drip_bytes_ != 0) next_ns_ = now + kDripNs;
  }
  if (now < gone_at_ns_ && !wire_->down.at_end() && !wire_->down.is_reset()) return;
  wire_->reset();
  wire_ = nullptr;
  dial_at_ns_ = now + random_.between(20, 1'500) * kMillisecond;
}

void Hostile::calm() {
  calm_ = true;
  if (wire_) wire_->reset();
  wire_ = nullptr;
}

void Hostile::dial() {
  const std::int64_t now = chronicle_->now_ns;
  dial_at_ns_ = now + random_.between(100, 1'000) * kMillisecond;
  if (!host_->listens(room_)) return;
  wire_ = make_wire(settings_->network, random_, *chronicle_);
  // What it says is wrong as it is: a flip could make it right.
  wire_->up.calm();
  wire_->room = room_;
  const bool stranger = kind_ == Kind::kStranger;
  wire_->address =
      server::PeerAddress::v4({10, static_cast<std::uint8_t>(stranger ? 200 : 201), 0, 1});
  wire_->number = chronicle_->counted(Event::kConnection);
  wire_->unwelcome = stranger;
  unsent_.clear();
  drip_bytes_ = 0;
  next_ns_ = now;
  gone_at_ns_ = now + random_.between(100, 12'000) * kMillisecond;
  reads_ = !random_.one_in(4);
  host_->accept(wire_);
  chronicle_->count(Event::kGarbage);
  if (kind_ == Kind::kStranger) return prepare_stranger();
  prepare_troublemaker();
}

void Hostile::say(const protocol::ClientMessage& message) {
  const protocol::Bytes bytes = protocol::encode(message);
  unsent_.insert(unsent_.end(), bytes.begin(), bytes.end());
}

void Hostile::say_garbage(std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i)
    unsent_.push_back(static_cast<std::byte>(random_.below(256)));
}

void Hostile::prepare_stranger() {
  protocol::Hello hello;
  hello.scene_digest = scene_digest_;
  hello.name = "stranger";
  switch (random_.below(kStrangerWays)) {
    case 0:
      hello.protocol_version += 1;
      return say(hello);
    case 1:
      hello.solver_version += 1;
      return say(hello);
    case 2:
      hello.scene_digest ^= 1;
      return say(hello);
    case 3:
      hello.seat_wish = 200;
      return say(hello);
    case 4:  // A size that is none, or over every limit.
      for (const int byte : {0, 0, random_.one_in(2) ? 0 : 255, 0}) {
        unsent_.push_back(static_cast<std::byte>(byte));
      }
      return say_garbage(16);
    case 5:  // A good size, and no message.
      for (const int byte : {64, 0, 0, 0}) unsent_.push_back(static_cast<std::byte>(byte));
      return say_garbage(64);
    case 6:  // Everything but a hello.
      return say(protocol::Input{random_.below(100), {}});
    case 7:  // Nothing at all.
      gone_at_ns_ = kNever;
      return;
    case 8:  // A secret that brings no seat back.
      hello.resume.resize(protocol::kResumeBytes);
      random_.fill(hello.resume);
      return say(hello);
    case 9:
    case 10:
    case 11:
    case 12:
      hello.token = bad_token();
      if (settings_->server.tokens == server::TokenPolicy::kIgnored) hello.scene_digest ^= 2;
      return say(hello);
    default:  // A hello that never comes to its end: byte after byte, for ever.
      hello.name = std::string(protocol::kNameBytesMax, 'x');
      say(hello);
      drip_bytes_ = 1;
      gone_at_ns_ = kNever;
      return;
  }
}

/// Of nobody, out of date, for another room, or already used by somebody.
std::vector<std::byte> Hostile::bad_token() {
  RoomHost& room = host_->room(room_);
  server::AdmissionToken token = room.issuer().token(room.name(), chronicle_->now_ns);
  token.identity = "stranger";
  const std::uint64_t way = random_.below(4);
  if (way == 0 && !room.used_token().empty()) return room.used_token();
  if (way == 1) token.room = "elsewhere";
  if (way == 2) {
    token.not_before_unix_s -= 200;
    token.expires_unix_s -= 200;
  }
  std::vector<std::byte> bytes = room.issuer().sign(token);
  if (way == 0 || way == 3) bytes[random_.below(bytes.size())] ^= std::byte{1};
  return bytes;
}

void Hostile::prepare_troublemaker() {
  RoomHost& room = host_->room(room_);
  room.ledger(wire_->era).excuse_inputs();
  room.excuse_desyncs();
  protocol::Hello hello;
  hello.scene_digest = scene_digest_;
  hello.name = "trouble\n\x7f";
  hello.mode = random_.one_in(2) ? protocol::Mode::kLockstep : protocol::Mode::kSnapshot;
  hello.seat_wish = random_.one_in(2) ? protocol::kAnySeat : protocol::kSpectator;
  if (settings_->server.tokens != server::TokenPolicy::kIgnored) {
    hello.token = room.issuer().sign(room.issuer().token(room.name(), chronicle_->now_ns));
  }
  trouble_ = random_.below(kTroubles);
  say(hello);
  next_ns_ = chronicle_->now_ns + random_.between(0, 1'000) * kMillisecond;
}

void Hostile::make_trouble() {
  if (unsent_.size() > 65536) return;
  const std::uint64_t tick = host_->room(room_).tick();
  next_ns_ = chronicle_->now_ns + random_.between(1, 200) * kMillisecond;
  switch (trouble_) {
    case 0:
      return say_garbage(1 + random_.below(200));
    case 1:  // More than a tick may hold, of ticks that are gone, to come, and far off.
      for (int i = 0; i < 200; ++i) {
        protocol::Input input{tick + random_.below(120), {}};
        input.tick -= std::min<std::uint64_t>(input.tick, 40);
        input.input.axes[0] = static_cast<std::int16_t>(random_.below(65536));
        say(input);
      }
      return;
    case 2:
      return say(protocol::Digest{tick + random_.below(50), random_.next()});
    case 3:
      return say(protocol::Digest{tick - tick % settings_->limits.digest_ticks, random_.next()});
    case 4:
      return say(protocol::Hello{});
    case 5:
      reads_ = false;
      return say(protocol::Ping{random_.next()});
    case 6:
      return say(protocol::Bye{"bye"});
    default:
      say(protocol::Ack{random_.below(tick + 100)});
      say(protocol::TickDigests{random_.below(tick + 1), {random_.next()}});
      return say(protocol::StatePart{random_.below(tick + 1), 4, 0, std::vector<std::byte>(4)});
  }
}

}  // namespace cycloid::sim
