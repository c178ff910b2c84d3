#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/backoff.hpp"
#include "client/replica/follower.hpp"
#include "client/replica/predictor.hpp"
#include "protocol/messages.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::client {

class ClientTls;

struct JoinOptions {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;
  scenes::Scene scene;
  protocol::Mode mode = protocol::Mode::kLockstep;
  std::int32_t seat_wish = protocol::kAnySeat;
  std::string name;
  std::string room;               ///< "": the only one, or the one that the token names.
  std::vector<std::byte> token;   ///< Signed admission; empty where the server asks for none.
  std::vector<std::byte> resume;  ///< Of an earlier Welcome, to get its seat back; or empty.
  protocol::Profile profile = protocol::Profile::kExact;  ///< Of a snapshot client's states.
  std::uint32_t predict_ticks = 0;  ///< Most ticks that a lockstep client predicts, up to 64.
  ReconnectOptions reconnect;
  std::shared_ptr<Witness> witness;      ///< Where empty: an Evidence, for desync reports.
  std::shared_ptr<const ClientTls> tls;  ///< Whom to trust; empty: plain TCP.
  std::uint64_t ticks = 0;               ///< Leave after so many ticks of the match; 0: stay.
  int workers = 1;    ///< At most: a step takes one alone while that is faster. Changes no bit.
  InputSource input;  ///< Where empty: scenes::scripted_input of the scene.
  std::chrono::milliseconds connect{5000};
  std::chrono::milliseconds handshake{10000};  ///< From the connection to the first snapshot.
  std::chrono::milliseconds silence{10000};
  /// Asked about every 50 ms, on the thread of `join`; true makes it leave.
  std::function<bool()> should_stop;
  /// Told whenever messages were taken in or ticks predicted, such as to draw the state. On every
  /// connection from its first state on: while one loads, what was drawn last stands.
  std::function<void(Follower&)> on_progress;
  /// Told each welcome, such as to keep its resume token.
  std::function<void(const protocol::Welcome&)> on_welcome;
  /// Told every confirmed frame and every notice, in order.
  std::function<void(const protocol::InputFrame&)> on_frame;
  std::function<void(const protocol::RoomNotice&)> on_notice;
};

/// What is wrong with the options, the first mistake alone: the option and why, or "". Asks neither
/// the server nor the name service, and does not build the scene: that a visit does.
std::string mistake_of(const JoinOptions& options);

enum class End : std::uint8_t {
  kTicks,         ///< The wanted number of ticks was seen.
  kBye,           ///< The server closed the match.
  kStopped,       ///< By `should_stop`.
  kRefused,       ///< By the server; `refused` says why.
  kDisconnected,  ///< No connection, or it broke, or a deadline passed.
  kFailed,  ///< The server broke the protocol, the options have a mistake, or the scene cannot run.
};

const char* end_name(End end);

struct JoinReport {
  End end = End::kFailed;
  std::string reason;
  Progress progress;              ///< Of the last connection, with the counts of all.
  std::uint64_t reconnects = 0;   ///< Times that a broken connection was followed by a welcome.
  std::uint64_t tries = 0;        ///< Connections begun after the first.
  std::uint64_t fresh_joins = 0;  ///< Welcomes after the server had forgotten the resume token.
  PredictorStatistics prediction;
  std::uint64_t final_digest = 0;  ///< Of the state at `progress.last_tick`.
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;

  const std::optional<protocol::Refused>& refused() const { return progress.refused; }
};

/// Plays in a room until the ticks are over, the server says goodbye or sends us away, or the
/// connection breaks for good. Blocks; but never longer than the deadlines where the server does
/// not answer, or as long as the system's name service takes, which nothing can interrupt.
JoinReport join(const JoinOptions& options);

}  // namespace cycloid::client
