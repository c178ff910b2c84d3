#pragma once

#include <array>
#include <asio.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "bench/load/samples.hpp"
#include "protocol/codec.hpp"
#include "protocol/messages.hpp"

namespace cycloid::load {

using Clock = std::chrono::steady_clock;

enum class Behaviour : std::uint8_t {
  kPlays,    ///< Reads all; says its input for every tick of its seat.
  kWatches,  ///< Reads all, says nothing.
  kIdles,    ///< Connects and says nothing at all.
  kDrips,    ///< A byte of its hello a second.
  kMute,     ///< Reads up to the Welcome, and never again.
};

struct ClientPlan {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;
  std::string room;
  std::uint64_t scene_digest = 0;
  protocol::Mode mode = protocol::Mode::kLockstep;
  protocol::Profile profile = protocol::Profile::kExact;
  Behaviour behaviour = Behaviour::kPlays;
};

/// What many clients have seen together; one thread.
struct ClientTally {
  std::uint64_t joined = 0;
  std::uint64_t refused = 0;
  std::uint64_t closed =
      0;  ///< Connections that the server or an error ended, refused ones among them.
  std::uint64_t frames = 0;
  std::uint64_t snapshots = 0;
  std::uint64_t gaps = 0;  ///< Frames that were not the next one.
  std::uint64_t bytes_in = 0;
  std::uint64_t update_bytes = 0;  ///< Of frames and snapshots alone, as they travel.
  std::string last_refusal;
  Samples frame_gap_ms;  ///< Between two frames, or snapshots, of a client.
  /// From when an input is queued to what shows its tick. A frame says whether the input was taken,
  /// and only then it counts; a snapshot does not, so that of these all count.
  Samples input_to_state_ms;
  Samples join_ms;  ///< From the connection to the first whole state.

  /// Forgets times and bytes, and keeps who is there: the warm-up is over.
  void begin_measuring();
};

/// A client of the wire alone: it steps no world, so that thousands fit beside the server.
class LoadClient : public std::enable_shared_from_this<LoadClient> {
 public:
  LoadClient(asio::io_context& io, const ClientPlan& plan, ClientTally& tally);
  void start();
  void stop();  ///< Ends the connection; it does not count as closed.

 private:
  void greet();
  void drip();
  void read();
  void take(std::size_t bytes);
  void watch_for_the_end();
  void on_message(const protocol::ServerMessage& message, std::size_t bytes);
  void on_frame(const protocol::InputFrame& frame);
  void on_state(std::uint64_t tick);
  void say_input(std::uint64_t tick);
  void send(const protocol::ClientMessage& message);
  void write();
  void end();

  ClientPlan plan_;
  ClientTally& tally_;
  asio::ip::tcp::socket socket_;
  asio::steady_timer timer_;
  protocol::Framer framer_{protocol::kServerMessageBytesMax};
  std::array<std::byte, 4096> incoming_{};
  std::deque<protocol::Bytes> queue_;
  protocol::Bytes hello_;
  std::size_t dripped_ = 0;
  bool writing_ = false;
  bool ended_ = false;
  bool has_state_ = false;
  bool silent_ = false;  ///< Reads no more.
  std::int32_t seat_ = protocol::kSpectator;
  std::uint32_t delay_ticks_ = 2;
  std::uint64_t last_tick_ = 0;
  Clock::time_point opened_;
  Clock::time_point updated_;
  std::deque<std::pair<std::uint64_t, Clock::time_point>> said_;  ///< Inputs not seen yet.
};

}  // namespace cycloid::load
