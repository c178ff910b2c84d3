#include "protocol/text.hpp"

#include <array>

namespace cycloid::protocol {

std::string hex16(std::uint64_t value) {
  std::string text(16, '0');
  for (std::size_t i = text.size(); i-- > 0; value >>= 4) text[i] = "0123456789abcdef"[value & 15];
  return text;
}

std::string printable(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text;
}

const char* origin_name(Origin origin) {
  switch (origin) {
    case Origin::kGiven:
      return "given";
    case Origin::kRepeated:
      return "repeated";
    case Origin::kAbsent:
      return "absent";
    case Origin::kNeutral:
      return "neutral";
  }
  return "unknown";
}

const char* event_kind_name(EventKind kind) {
  switch (kind) {
    case EventKind::kJoin:
      return "join";
    case EventKind::kLeave:
      return "leave";
    case EventKind::kKick:
      return "kick";
    case EventKind::kLost:
      return "lost";
    case EventKind::kResume:
      return "resume";
  }
  return "unknown";
}

const char* change_kind_name(ChangeKind kind) {
  return kind == ChangeKind::kInputDelay ? "input_delay" : "unknown";
}

const char* refusal_name(Refusal code) {
  static constexpr std::array kNames = {
      "kProtocolVersion", "kSolverVersion", "kSceneDigest",  "kSeatTaken", "kNoSuchSeat",
      "kRoomFull",        "kBadMessage",    "kTooLarge",     "kTooSlow",   "kDraining",
      "kFaulted",         "kTokenInvalid",  "kTokenExpired", "kTokenUsed", "kTokenScope",
      "kNoSuchRoom",      "kRoomLocked",    "kRateLimited",  "kKicked",    "kReplaced",
      "kResumeUnknown",   "kResyncLimit",
  };
  static_assert(kNames.size() == static_cast<std::size_t>(kLastRefusal));
  const auto number = static_cast<std::size_t>(code);
  return number >= 1 && number <= kNames.size() ? kNames[number - 1] : "an unknown code";
}

}  // namespace cycloid::protocol
