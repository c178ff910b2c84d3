#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/desync/finding.hpp"

namespace cycloid::server {

/// One number that the two sides have otherwise.
struct ReportedValue {
  std::string object;  ///< "body 3"
  std::string name;    ///< What the scene calls it, or "".
  std::string about;   ///< "bodies 2 and 5", or "".
  std::string field;
  std::string server;  ///< Decimal, and the bits in hexadecimal.
  std::string client;
  int bits = 0;  ///< That differ.
};

/// What is known about a desync: of values, no matter where it goes.
struct DesyncReport {
  RoomIdentity room;
  ClientIdentity client;
  std::uint64_t tick = 0;
  bool is_first = false;  ///< The tick before is known to be equal on both sides.
  std::uint64_t noticed_tick = 0;
  std::uint64_t server_digest = 0;
  std::uint64_t client_digest = 0;
  /// Of the same tick, made again from a state of the server's; none where it could not be.
  std::optional<std::uint64_t> remade_digest;
  std::uint64_t remade_from_tick = 0;
  /// Of the server after the tick before `tick`, made again; none where the server had another one.
  std::optional<KeptState> before;

  std::uint64_t values_tick = 0;        ///< Of which tick the values are.
  std::vector<ReportedValue> values;    ///< The first is where to look; at most kReportedValuesMax.
  std::uint64_t differences = 0;        ///< Numbers that differ in all.
  std::uint64_t objects = 0;            ///< To which they belong.
  std::string phase;                    ///< Of the tick: "sweep, substep 0, sweep 1"; "" unknown.
  std::string phase_reason;             ///< Why that one.
  std::vector<std::string> written_in;  ///< All phases of the tick that write the first value.

  ReplicaVotes votes;
  bool server_suspect = false;
  std::string verdict;             ///< Which side went wrong, as far as can be said: a sentence.
  std::vector<std::string> notes;  ///< What is missing or strange, in sentences.
  std::vector<protocol::LogTick> inputs;  ///< Around `tick`, with the server's digests.
};

inline constexpr std::size_t kReportedValuesMax = 16;
inline constexpr int kReportSchemaVersion = 1;
/// Ticks of inputs on each side of the one that differs.
inline constexpr std::uint64_t kReportInputTicks = 8;

/// Looks into a finding: makes the server's tick again from a state before it, compares it with
/// what the client sent, and weighs who is wrong. A pure function that may take as long as the
/// ticks since that state; for another thread than the room's. Never fails otherwise than by notes.
DesyncReport investigate(const Finding& finding);

/// Names of the files that lie beside a report.
struct ReportFiles {
  std::string report;      ///< "desync-....json"
  std::string log;         ///< "" where there is none, ...
  std::string log_reason;  ///< ... and why.
};

/// The report as JSON, with `schema_version`, "\n" at its end.
std::string report_json_text(const DesyncReport& report, const ReportFiles& files);
/// A report's JSON as a text for people; none, with a reason in `error`, where it is no report of a
/// version that is known here.
std::optional<std::string> report_as_text(const std::string& json, std::string& error);
/// One line for the server's log and for the client's user.
std::string report_line(const DesyncReport& report);

}  // namespace cycloid::server
