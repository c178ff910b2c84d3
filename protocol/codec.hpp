#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/messages.hpp"

namespace cycloid::protocol {

using Bytes = std::vector<std::byte>;

/// One size-prefixed FlatBuffer: 4 bytes little-endian payload size, then the payload.
Bytes encode(const ClientMessage& message);
Bytes encode(const ServerMessage& message);
/// A frame in half of the bytes, for a client of minor version kPackedFramesMinor at least. It is
/// decoded to an InputFrame like any other.
Bytes encode_packed(const InputFrame& frame);

/// A message, or why the bytes are none. `payload` is without the size prefix.
template <class Message>
struct Decoded {
  std::optional<Message> message;
  std::string error;
};

/// Verified (structure, depth and table limits per direction), then validated (ranges, unknown
/// enumerators, lengths, UTF-8). Never reads outside `payload`; allocates at most its size, or
/// 12 times that of a packed frame.
Decoded<ClientMessage> decode_client(std::span<const std::byte> payload);
Decoded<ServerMessage> decode_server(std::span<const std::byte> payload);

/// Cuts a byte stream into payloads, whatever the segmentation. The size is checked against the
/// limit before anything is reserved for it.
class Framer {
 public:
  explicit Framer(std::uint32_t payload_bytes_max) : payload_bytes_max_(payload_bytes_max) {}
  void set_limit(std::uint32_t payload_bytes_max) { payload_bytes_max_ = payload_bytes_max; }

  /// Takes bytes in; false once a size over the limit (or zero) was announced, for ever after.
  bool feed(std::span<const std::byte> bytes);
  /// The next whole payload, if one is there. Valid until the next call.
  std::optional<std::span<const std::byte>> next();
  std::uint32_t announced_bytes() const;  ///< Of the payload that was refused, for the reason.
  /// What `feed` has said, or will say: `next` may be the first to see a refused size.
  bool broken() const { return broken_; }
  std::size_t held_bytes() const { return buffer_.size() - begin_ - taken_; }

  static constexpr std::size_t kPrefixBytes = 4;

 private:
  void check_first();

  Bytes buffer_;
  std::size_t begin_ = 0;
  std::size_t taken_ = 0;
  std::uint32_t payload_bytes_max_;
  bool broken_ = false;
};

}  // namespace cycloid::protocol
