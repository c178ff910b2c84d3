#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "protocol/codec.hpp"
#include "protocol/little_endian.hpp"
#include "protocol/schema/common_generated.h"
#include "protocol/utf8.hpp"

/// What the codecs of both directions have in common.
namespace cycloid::protocol::wire_buffer {

// Every table is built in statements of its own: two calls that change the builder in one argument
// list would come in an order that differs between GCC and Clang, and so would the bytes.

using Builder = flatbuffers::FlatBufferBuilder;

/// A message is a root table and its body, and nothing nests deeper than struct in vector in table.
inline constexpr flatbuffers::uoffset_t kDepthMax = 8;
inline constexpr flatbuffers::uoffset_t kTablesMax = 4;
/// Offset to the root, then the file identifier.
inline constexpr std::size_t kPayloadBytesMin = 8;

inline wire::SeatInput to_wire(const scenes::SeatInput& input) {
  return {flatbuffers::span<const std::int16_t, scenes::kAxes>(input.axes), input.buttons};
}

inline scenes::SeatInput from_wire(const wire::SeatInput& input) {
  scenes::SeatInput result;
  for (std::size_t axis = 0; axis < result.axes.size(); ++axis) {
    result.axes[axis] = input.axes()->Get(static_cast<flatbuffers::uoffset_t>(axis));
  }
  result.buttons = input.buttons();
  return result;
}

inline flatbuffers::Offset<flatbuffers::String> reason_of(const std::string& reason, Builder& to) {
  return to.CreateString(cut_utf8(reason, kReasonBytesMax));
}

/// Nothing is left out of the bytes, which then are those of a version that had no such field.
inline flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>> bytes_of(
    const std::vector<std::byte>& bytes, Builder& to) {
  if (bytes.empty()) return {};
  return to.CreateVector(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

inline flatbuffers::Offset<flatbuffers::String> text_of(const std::string& text, Builder& to) {
  if (text.empty()) return {};
  return to.CreateString(text);
}

inline Bytes with_prefix(const Builder& builder) {
  const auto payload_bytes = static_cast<std::uint32_t>(builder.GetSize());
  const auto* payload = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  Bytes bytes;
  bytes.reserve(Framer::kPrefixBytes + payload_bytes);
  append_little(payload_bytes, bytes);
  bytes.insert(bytes.end(), payload, payload + payload_bytes);
  return bytes;
}

/// The payload at an address where its numbers are aligned, as FlatBuffers reads them in place. One
/// lies 4 bytes into what a framer holds, so nearly each is copied: a short one, such as an input,
/// without an allocation.
class Aligned {
 public:
  explicit Aligned(std::span<const std::byte> payload)
      : data_(payload.data()), bytes_(payload.size()) {
    if (reinterpret_cast<std::uintptr_t>(data_) % alignof(std::uint64_t) == 0) return;
    std::uint64_t* copy = short_.data();
    if (bytes_ > sizeof short_) {
      long_ = std::make_unique_for_overwrite<std::uint64_t[]>((bytes_ + 7) / 8);
      copy = long_.get();
    }
    std::memcpy(copy, data_, bytes_);
    data_ = reinterpret_cast<const std::byte*>(copy);
  }
  Aligned(const Aligned&) = delete;
  Aligned& operator=(const Aligned&) = delete;
  const std::uint8_t* data() const { return reinterpret_cast<const std::uint8_t*>(data_); }
  std::size_t size() const { return bytes_; }

 private:
  const std::byte* data_;
  std::size_t bytes_;
  std::array<std::uint64_t, 32> short_;  ///< Set where it is used.
  std::unique_ptr<std::uint64_t[]> long_;
};

template <class Root>
const Root* verified(const Aligned& payload, const char* identifier, std::string& error) {
  if (!flatbuffers::BufferHasIdentifier(payload.data(), identifier)) {
    error = std::string("the file identifier is not ") + identifier;
    return nullptr;
  }
  flatbuffers::Verifier verifier(payload.data(), payload.size(), kDepthMax, kTablesMax);
  if (!verifier.VerifyBuffer<Root>(identifier)) {
    error = "the structure is damaged";
    return nullptr;
  }
  return flatbuffers::GetRoot<Root>(payload.data());
}

/// Before anything is copied, and before the identifier is looked for, which reads 8 bytes.
inline bool fits(std::size_t payload_bytes, std::uint32_t bytes_max, std::string& error) {
  if (payload_bytes >= kPayloadBytesMin && payload_bytes <= bytes_max) return true;
  error = "a payload of " + std::to_string(payload_bytes) + " bytes";
  return false;
}

// Validation: what the verifier does not look at. Each sets `error` and returns nothing, or returns
// the message.

template <class Message>
std::optional<Message> refuse(std::string& error, std::string why) {
  error = std::move(why);
  return {};
}

inline bool read_text(const flatbuffers::String* from, std::size_t bytes_max, const char* what,
                      std::string& into, std::string& error) {
  if (from == nullptr) return true;
  if (from->size() > bytes_max) {
    error = std::string(what) + " of " + std::to_string(from->size()) + " bytes, of at most " +
            std::to_string(bytes_max);
    return false;
  }
  into.assign(from->c_str(), from->size());
  if (is_utf8(into)) return true;
  error = std::string(what) + " is not UTF-8";
  return false;
}

inline bool read_bytes(const flatbuffers::Vector<std::uint8_t>* from, std::size_t bytes_max,
                       const char* what, std::vector<std::byte>& into, std::string& error) {
  if (from == nullptr) return true;
  if (from->size() > bytes_max) {
    error = std::string(what) + " of " + std::to_string(from->size()) + " bytes, of at most " +
            std::to_string(bytes_max);
    return false;
  }
  const auto* bytes = reinterpret_cast<const std::byte*>(from->data());
  into.assign(bytes, bytes + from->size());
  return true;
}

/// Whether the elements lie where numbers of their size may: the verifier of FlatBuffers looks at
/// the length before them alone, which is one of 4 bytes.
template <class T>
bool is_aligned(const flatbuffers::Vector<T>& from) {
  return reinterpret_cast<std::uintptr_t>(from.Data()) % alignof(T) == 0;
}

/// A secret of a fixed size, or none.
inline bool read_resume(const flatbuffers::Vector<std::uint8_t>* from, std::vector<std::byte>& into,
                        std::string& error) {
  if (!read_bytes(from, kResumeBytes, "a resume token", into, error)) return false;
  if (into.empty() || into.size() == kResumeBytes) return true;
  error = "a resume token of " + std::to_string(into.size()) + " bytes instead of " +
          std::to_string(kResumeBytes);
  return false;
}

/// A part of something larger, at its place: whether offset and size fit the total.
inline bool part_fits(std::uint32_t total_bytes, std::uint32_t offset, std::size_t bytes,
                      std::string& error) {
  if (bytes != 0 && offset <= total_bytes && bytes <= total_bytes - offset) return true;
  error = "a part of " + std::to_string(bytes) + " bytes at " + std::to_string(offset) + " of " +
          std::to_string(total_bytes);
  return false;
}

inline bool is_profile(Profile profile) {
  return profile == Profile::kExact || profile == Profile::kQuantised;
}

/// The highest tick that a message speaks of; 0 where it speaks of none.
template <class Message>
std::uint64_t highest_tick(const Message& message) {
  if constexpr (requires { message.tick; }) return message.tick;
  return 0;
}
inline std::uint64_t highest_tick(const TickDigests& said) {
  return said.first_tick;  // Its digests are few.
}
inline std::uint64_t highest_tick(const RoomNotice& notice) {
  const bool rewound = notice.kind == NoticeKind::kRewound;
  return rewound ? std::max(notice.tick, notice.value) : notice.tick;
}

/// The body, unless it could not be read or speaks of a tick that none has.
template <class Message, class Body>
void take_body(std::optional<Body>&& body, Decoded<Message>& into) {
  if (!body) return;
  const std::uint64_t tick = highest_tick(*body);
  if (tick < kTickEnd)
    into.message.emplace(std::move(*body));
  else
    into.error = "tick " + std::to_string(tick) + ", of less than " + std::to_string(kTickEnd);
}

// What both directions say.

inline flatbuffers::Offset<void> build(const Digest& digest, Builder& to) {
  return wire::CreateDigest(to, digest.tick, digest.digest).Union();
}

inline flatbuffers::Offset<void> build(const Bye& bye, Builder& to) {
  const auto reason = reason_of(bye.reason, to);
  return wire::CreateBye(to, reason).Union();
}

inline std::optional<Digest> read(const wire::Digest& from, std::string&) {
  return Digest{from.tick(), from.digest()};
}

inline std::optional<Bye> read(const wire::Bye& from, std::string& error) {
  Bye bye;
  if (!read_text(from.reason(), kReasonBytesMax, "a reason", bye.reason, error)) return {};
  return bye;
}

}  // namespace cycloid::protocol::wire_buffer
