#include "client/join.hpp"

namespace cycloid::client {
namespace {

std::string longer_than(std::size_t bytes) {
  return "longer than " + std::to_string(bytes) + " bytes";
}

std::string mistake_of_way(const JoinOptions& options) {
  if (options.host.empty()) return "host: empty";
  if (options.port == 0) return "port: not 1 to 65535";
  if (options.name.size() > protocol::kNameBytesMax)
    return "name: " + longer_than(protocol::kNameBytesMax);
  if (options.room.size() > protocol::kRoomNameBytesMax)
    return "room: " + longer_than(protocol::kRoomNameBytesMax);
  if (options.token.size() > protocol::kTokenBytesMax)
    return "token: " + longer_than(protocol::kTokenBytesMax);
  if (!options.resume.empty() && options.resume.size() != protocol::kResumeBytes)
    return "resume: not " + std::to_string(protocol::kResumeBytes) + " bytes";
  return "";
}

std::string mistake_of_stay(const JoinOptions& options) {
  const bool snapshot = options.mode == protocol::Mode::kSnapshot;
  if (!snapshot && options.mode != protocol::Mode::kLockstep) return "mode: none that there is";
  if (options.profile != protocol::Profile::kExact &&
      options.profile != protocol::Profile::kQuantised)
    return "profile: none that there is";
  if (options.seat_wish < protocol::kSpectator) return "seat: not a seat, -1 or -2";
  if (options.predict_ticks > Predictor::kWindowTicksMax)
    return "predict_ticks: over " + std::to_string(Predictor::kWindowTicksMax);
  if (options.predict_ticks != 0 && snapshot)
    return "predict_ticks: a snapshot client predicts nothing";
  if (options.workers < 1 || options.workers > 64) return "workers: not 1 to 64";
  return "";
}

}  // namespace

std::string mistake_of(const JoinOptions& options) {
  std::string mistake = mistake_of_way(options);
  return mistake.empty() ? mistake_of_stay(options) : mistake;
}

}  // namespace cycloid::client
