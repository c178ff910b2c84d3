#include "protocol/log/header.hpp"

#include <algorithm>
#include <array>

#include "protocol/crc32c.hpp"
#include "protocol/little_endian.hpp"
#include "protocol/messages.hpp"
#include "protocol/utf8.hpp"
#include "scenes/catalogue.hpp"
#include "scenes/scene.hpp"
#include "solver/version.hpp"

namespace cycloid::protocol {
namespace {

constexpr std::array<char, 8> kMagic = {'C', 'Y', 'C', 'L', 'O', 'G', '\r', '\n'};
constexpr std::size_t kFixedBytes = 16;  ///< Magic, format, payload size.
constexpr std::size_t kHeaderCheckBytes = 4;

template <class Range>
void append_sized(const Range& range, Bytes& into) {
  append_little(static_cast<std::uint32_t>(range.size()), into);
  for (const auto element : range) into.push_back(static_cast<std::byte>(element));
}

void take_text(LittleReader& reader, std::string& text) {
  const auto bytes = reader.take_bytes(reader.take<std::uint32_t>());
  text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

bool read_payload(std::span<const std::byte> payload, LogHeader& header) {
  LittleReader reader{payload};
  header.protocol_version = reader.take<std::uint32_t>();
  header.solver_version = reader.take<std::uint32_t>();
  header.scene_digest = reader.take<std::uint64_t>();
  header.salt = reader.take<std::uint64_t>();
  header.schema = reader.take<std::uint32_t>();
  header.tick_rate_millihertz = reader.take<std::uint32_t>();
  header.start_unix_ns = static_cast<std::int64_t>(reader.take<std::uint64_t>());
  header.log_id = reader.take<std::uint64_t>();
  header.parent_log_id = reader.take<std::uint64_t>();
  header.branch_tick = reader.take<std::uint64_t>();
  take_text(reader, header.build);
  take_text(reader, header.room);
  take_text(reader, header.scene_name);
  const auto scene = reader.take_bytes(reader.take<std::uint32_t>());
  header.scene.assign(scene.begin(), scene.end());
  const bool readable = is_utf8(header.build) && is_utf8(header.room) && is_utf8(header.scene_name);
  return !reader.failed && reader.bytes.empty() && readable && header.branch_tick < kTickEnd;
}

std::string both(const std::string& what, const std::string& theirs, std::uint32_t ours) {
  return what + " " + theirs + ", here " + std::to_string(ours);
}

/// Why a header cannot be used here; "" where it can.
std::string incompatibility(const LogHeader& header, std::span<const std::uint32_t> solvers) {
  const auto text = [](std::uint32_t number) { return std::to_string(number); };
  if (header.protocol_version != kProtocolVersion)
    return both("protocol version", text(header.protocol_version), kProtocolVersion);
  if (std::find(solvers.begin(), solvers.end(), header.solver_version) == solvers.end()) {
    const std::string by = header.build.empty() ? "" : " (written by " + header.build + ")";
    return both("solver version", text(header.solver_version), solver::kSolverVersion) + by;
  }
  if (header.schema != kLogSchema) return both("log schema", text(header.schema), kLogSchema);
  return "";
}

}  // namespace

LogHeader log_header_of(const scenes::Scene& scene) {
  LogHeader header;
  header.scene_digest = scenes::scene_digest(scene);
  header.scene_name = scene.name;
  header.scene = scenes::to_binary(scene);
  return header;
}

bool looks_like_log(std::span<const std::byte> bytes) {
  const auto* magic = reinterpret_cast<const std::byte*>(kMagic.data());
  return bytes.size() >= kMagic.size() && std::equal(magic, magic + kMagic.size(), bytes.begin());
}

std::uint32_t append_log_header(const LogHeader& header, Bytes& into) {
  const std::size_t begin = into.size();
  for (const char c : kMagic) into.push_back(static_cast<std::byte>(c));
  append_little(kLogFormat, into);
  append_little(std::uint32_t{0}, into);  // The size, once it is known.
  append_little(header.protocol_version, into);
  append_little(header.solver_version, into);
  append_little(header.scene_digest, into);
  append_little(header.salt, into);
  append_little(header.schema, into);
  append_little(header.tick_rate_millihertz, into);
  append_little(static_cast<std::uint64_t>(header.start_unix_ns), into);
  append_little(header.log_id, into);
  append_little(header.parent_log_id, into);
  append_little(header.branch_tick, into);
  append_sized(header.build, into);
  append_sized(header.room, into);
  append_sized(header.scene_name, into);
  append_sized(header.scene, into);
  solver::store_little(static_cast<std::uint32_t>(into.size() - begin - kFixedBytes),
                       into.data() + begin + kFixedBytes - 4);
  const std::uint32_t check = crc32c(std::span<const std::byte>(into).subspan(begin));
  append_little(check, into);
  return check;
}

ReadHeader read_log_header(std::span<const std::byte> bytes,
                           std::span<const std::uint32_t> solver_versions) {
  ReadHeader read;
  if (bytes.size() < kFixedBytes || !looks_like_log(bytes)) {
    read.reason = "not a log: no header at byte 0";
    return read;
  }
  LittleReader reader{bytes.subspan(kMagic.size())};
  const auto format = reader.take<std::uint32_t>();
  const std::size_t payload_bytes = reader.take<std::uint32_t>();
  if (format != kLogFormat) {
    read.state = LogState::kIncompatible;
    read.reason = both("log format", std::to_string(format), kLogFormat);
    return read;
  }
  const auto payload = reader.take_bytes(payload_bytes);
  const auto check = reader.take<std::uint32_t>();
  if (reader.failed) {
    read.reason = "a header that is cut or damaged, at byte 0";
    return read;
  }
  const std::size_t checked = kFixedBytes + payload_bytes;
  if (crc32c(bytes.first(checked)) != check || !read_payload(payload, read.header)) {
    read.reason = "a damaged header, at byte 0";
    return read;
  }
  read.reason = incompatibility(read.header, solver_versions);
  if (!read.reason.empty()) {
    read.state = LogState::kIncompatible;
    return read;
  }
  read.state = LogState::kOpen;
  read.bytes = checked + kHeaderCheckBytes;
  read.check = check;
  return read;
}

}  // namespace cycloid::protocol
