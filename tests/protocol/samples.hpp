#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "protocol/codec.hpp"
#include "protocol/log_format.hpp"
#include "protocol/messages.hpp"

namespace cycloid::protocol::samples {

inline Hello hello() {
  Hello hello;
  hello.protocol_version = 1;
  hello.solver_version = 7;
  hello.scene_digest = 0x1122334455667788;
  hello.mode = Mode::kSnapshot;
  hello.seat_wish = 3;
  hello.name = "Grüße";
  hello.protocol_minor = 0;  // As the first of them said it.
  return hello;
}

/// With everything that version 2 can say.
inline Hello full_hello() {
  Hello hello = samples::hello();
  hello.protocol_version = 2;
  hello.protocol_minor = 1;
  hello.room = "arena-1";
  hello.token.assign(kTokenBytesMax, std::byte{0x17});
  hello.resume.assign(kResumeBytes, std::byte{0x71});
  hello.build = "GNU 12.2 -O3";
  hello.profile = Profile::kQuantised;
  return hello;
}

inline Welcome welcome() {
  Welcome welcome{1, 4, 100, 59940, 3};
  welcome.protocol_minor = 1;
  welcome.room = "arena-1";
  welcome.resume.assign(kResumeBytes, std::byte{0x44});
  welcome.build = "Clang 19";
  welcome.digest_ticks = 30;
  return welcome;
}

inline InputFrame frame(std::uint64_t tick) {
  InputFrame frame;
  frame.tick = tick;
  frame.seats = {{Origin::kGiven, {{1, -2, 32767, -32768}, 0xbeef}},
                 {Origin::kRepeated, {{5, 6, 7, 8}, 1}},
                 {Origin::kAbsent, {}}};
  frame.events = {{EventKind::kJoin, 0}, {EventKind::kLeave, 2}};
  frame.changes = {{ChangeKind::kInputDelay, 3}};
  return frame;
}

/// Each message a client has, with a value in every field.
inline std::vector<ClientMessage> client_messages() {
  return {hello(),
          Input{9, {{1, -2, 32767, -32768}, 0x8001}},
          Digest{11, 0xfedcba9876543210},
          Ping{12},
          Bye{"gone home"},
          full_hello(),
          Ack{13},
          TickDigests{14, {15, 16, 17}},
          StatePart{18, 100, 63, std::vector<std::byte>(37, std::byte{0x5a})}};
}

/// Each message a server has, with a value in every field.
inline std::vector<ServerMessage> server_messages() {
  const std::vector<std::byte> state(37, std::byte{0x5a});
  return {Welcome{1, 4, 100, 59940, 3, 0, {}, {}, {}, 60},
          welcome(),
          Refused{Refusal::kSeatTaken, "seat 1"},
          frame(101),
          Snapshot{102, 0xabcdef, state},
          Digest{103, 5},
          Pong{104, 105},
          Bye{"the end"},
          SnapshotPart{106, 107, 100, 63, state},
          StateDelta{108, 98, 109, Profile::kQuantised, state},
          Margin{110, -3, 2, 1},
          StateWanted{111},
          RoomNotice{NoticeKind::kRewound, 112, 113, "back to 113"}};
}

inline std::span<const std::byte> payload_of(const Bytes& message) {
  return std::span<const std::byte>(message).subspan(Framer::kPrefixBytes);
}

inline LogHeader log_header(std::uint64_t salt = 0x5a17) {
  LogHeader header;
  header.scene_digest = 0x77;
  header.salt = salt;
  header.tick_rate_millihertz = 59940;
  header.start_unix_ns = -5;
  header.log_id = 0x1d;
  header.build = "GNU 12.2 -O3";
  header.room = "arena-1";
  header.scene_name = "two balls";
  header.scene.assign(21, std::byte{0x33});
  return header;
}

/// The bytes of a log and where each of its records ends; the first is the header, the last the
/// footer.
struct LogSample {
  Bytes bytes;
  std::vector<std::size_t> ends;
  std::vector<std::uint64_t> ticks_until;  ///< Whole ticks up to each end.
};

/// Inputs that change, in every field at some tick.
inline LogTick log_tick(std::uint64_t tick) {
  InputFrame logged = frame(tick);
  const auto number = static_cast<std::int16_t>(tick * 2711);
  logged.seats[0].input.axes[tick % 4] = number;
  logged.seats[1].input.buttons = static_cast<std::uint16_t>(number);
  logged.seats[2].origin = tick % 3 == 0 ? Origin::kNeutral : Origin::kAbsent;
  if (tick % 5 == 1) logged.seats.resize(tick % 2 == 0 ? 3 : 5);
  if (tick % 2 == 0) logged.events.clear();
  if (tick % 3 == 0) logged.changes.clear();
  return {logged, 1000 + tick};
}

/// @param state_bytes  Of a keyframe after every second tick; 0: none.
inline LogSample log_sample(std::uint64_t ticks, std::uint64_t salt = 0x5a17,
                            std::size_t state_bytes = 0) {
  LogSample sample;
  LogEncoder encoder(log_header(salt), sample.bytes);
  const auto mark = [&](std::uint64_t until) {
    sample.ends.push_back(sample.bytes.size());
    sample.ticks_until.push_back(until);
  };
  mark(0);
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    encoder.tick(log_tick(tick), sample.bytes);
    mark(tick);
    if (state_bytes == 0 || tick % 2 != 0) continue;
    encoder.keyframe(1000 + tick, Bytes(state_bytes, static_cast<std::byte>(tick)), sample.bytes);
    mark(tick);
  }
  encoder.footer({ticks, 1000 + ticks, {}}, sample.bytes);
  mark(ticks);
  return sample;
}

}  // namespace cycloid::protocol::samples
