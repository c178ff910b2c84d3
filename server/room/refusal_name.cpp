#include "server/room/room.hpp"

namespace cycloid::server {

const char* refusal_name(protocol::Refusal code) {
  switch (code) {
    case protocol::Refusal::kProtocolVersion:
      return "kProtocolVersion";
    case protocol::Refusal::kSolverVersion:
      return "kSolverVersion";
    case protocol::Refusal::kSceneDigest:
      return "kSceneDigest";
    case protocol::Refusal::kSeatTaken:
      return "kSeatTaken";
    case protocol::Refusal::kNoSuchSeat:
      return "kNoSuchSeat";
    case protocol::Refusal::kRoomFull:
      return "kRoomFull";
    case protocol::Refusal::kBadMessage:
      return "kBadMessage";
    case protocol::Refusal::kTooLarge:
      return "kTooLarge";
    case protocol::Refusal::kTooSlow:
      return "kTooSlow";
    case protocol::Refusal::kDraining:
      return "kDraining";
    case protocol::Refusal::kFaulted:
      return "kFaulted";
    case protocol::Refusal::kTokenInvalid:
      return "kTokenInvalid";
    case protocol::Refusal::kTokenExpired:
      return "kTokenExpired";
    case protocol::Refusal::kTokenUsed:
      return "kTokenUsed";
    case protocol::Refusal::kTokenScope:
      return "kTokenScope";
    case protocol::Refusal::kNoSuchRoom:
      return "kNoSuchRoom";
    case protocol::Refusal::kRoomLocked:
      return "kRoomLocked";
    case protocol::Refusal::kRateLimited:
      return "kRateLimited";
    case protocol::Refusal::kKicked:
      return "kKicked";
    case protocol::Refusal::kReplaced:
      return "kReplaced";
    case protocol::Refusal::kResumeUnknown:
      return "kResumeUnknown";
    case protocol::Refusal::kResyncLimit:
      return "kResyncLimit";
  }
  return "unknown";
}

}  // namespace cycloid::server
