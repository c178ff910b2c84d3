#include <algorithm>
#include <bit>
#include <memory>
#include <utility>

#include "protocol/text.hpp"
#include "scenes/object_names.hpp"
#include "server/desync/report.hpp"
#include "solver/encoding.hpp"
#include "solver/trace.hpp"
#include "solver/tracing/compare_encodings.hpp"
#include "solver/tracing/named_words.hpp"
#include "solver/tracing/writes.hpp"

namespace cycloid::server {
namespace {

std::string error_words(const solver::Error& error) {
  return std::string(solver::code_name(error.code)) + " " + error.field +
         (error.index < 0 ? "" : " " + std::to_string(error.index));
}

ReportedValue reported(const solver::EncodedDifference& from, const scenes::Scene& scene) {
  ReportedValue value{from.object(),
                      "",
                      from.about,
                      from.field,
                      from.value_a,
                      from.value_b,
                      std::popcount(from.bits_a ^ from.bits_b)};
  value.name = scenes::scene_name_of(scene, from.kind, from.slot, from.generation);
  if (from.generation != 0) {
    value.about +=
        (value.about.empty() ? "generation " : ", generation ") + std::to_string(from.generation);
  }
  if (from.kind != "register") return value;
  const scenes::RegisterUse use = scenes::register_use(scene, from.slot);
  value.name = use.owner;
  if (!use.field.empty()) value.field = use.field;
  if (use.is_float && from.value_a != "absent" && from.value_b != "absent") {
    const auto as_float = [](std::uint64_t bits) {
      return solver::value_text(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    };
    value.server = as_float(from.bits_a);
    value.client = as_float(from.bits_b);
  }
  return value;
}

/// The server's world, made again. Each step of the work notes what it could not do.
class Investigation {
 public:
  explicit Investigation(const Finding& finding) : finding_(finding) {
    report_.room = *finding.room;
    report_.client = finding.client;
    report_.tick = report_.values_tick = finding.tick;
    report_.is_first = finding.is_first;
    report_.noticed_tick = finding.noticed_tick;
    report_.server_digest = finding.server_digest;
    report_.client_digest = finding.client_digest;
    report_.votes = finding.votes;
    for (const protocol::LogTick& tick : finding.ticks) {
      const std::uint64_t at = tick.frame.tick;
      if (at + kReportInputTicks >= finding.tick && at <= finding.tick + kReportInputTicks)
        report_.inputs.push_back(tick);
    }
  }

  DesyncReport run() {
    if (remake()) {
      if (parted_tick_) compare_server_with_itself();
      if (report_.values.empty()) compare(made_, finding_.client_state);
      if (!report_.values.empty() && report_.values_tick == report_.tick) find_phase();
    } else if (finding_.later && finding_.later->tick == finding_.tick) {
      compare(*finding_.later->state, finding_.client_state);
    }
    check_client();
    judge();
    return std::move(report_);
  }

 private:
  void note(std::string text) { report_.notes.push_back(std::move(text)); }

  std::vector<scenes::SeatInput> inputs(std::uint64_t tick) const {
    std::vector<scenes::SeatInput> inputs;
    for (const protocol::LogTick& made : finding_.ticks)
      if (made.frame.tick == tick)
        for (const protocol::SeatFrame& seat : made.frame.seats) inputs.push_back(seat.input);
    return inputs;
  }

  /// Steps to the tick, and on to the later state where the server's digests turn out not to be
  /// those of its own steps. False, with a note, where there is no way.
  bool remake() {
    if (!finding_.start) return give_up("no state of the server before the tick is kept any more");
    auto made = scenes::Simulation::create(*finding_.room->scene);
    if (!made.ok()) return give_up("the scene does not run: " + error_words(made.error()));
    simulation_.emplace(std::move(made.value()));
    if (const solver::Error error = simulation_->decode(*finding_.start->state); !error.ok())
      return give_up("the server's kept state is none: " + error_words(error));
    report_.remade_from_tick = finding_.start->tick;
    if (simulation_->digest() != finding_.start->digest) parted_tick_ = finding_.start->tick;
    for (const protocol::LogTick& tick : finding_.ticks) {
      if (tick.frame.tick != simulation_->tick() + 1) continue;
      if (tick.frame.tick == finding_.tick) keep_before();
      if (tick.frame.tick > finding_.tick && !wants_later(tick.frame.tick)) break;
      if (const solver::Error error = simulation_->step(inputs(tick.frame.tick)); !error.ok())
        return give_up("the world does not step again: " + error_words(error));
      const std::uint64_t digest = simulation_->digest();
      if (digest != tick.digest && !parted_tick_) parted_tick_ = tick.frame.tick;
      if (tick.frame.tick == finding_.tick) {
        report_.remade_digest = digest;
        simulation_->encode(made_);
      }
      if (finding_.later && tick.frame.tick == finding_.later->tick)
        simulation_->encode(made_later_);
    }
    if (!report_.remade_digest) return give_up("the frames up to the tick are not kept any more");
    return true;
  }
  /// The state is the server's own only where its digests have been those of its steps so far.
  void keep_before() {
    simulation_->save(before_);
    if (parted_tick_) return;
    auto state = std::make_shared<std::vector<std::byte>>();
    simulation_->encode(*state);
    report_.before = KeptState{simulation_->tick(), simulation_->digest(), std::move(state)};
  }
  bool wants_later(std::uint64_t tick) const {
    return parted_tick_ && finding_.later && tick <= finding_.later->tick;
  }
  bool give_up(std::string why) {
    note("the tick could not be made again: " + std::move(why));
    return false;
  }

  /// The server did not do what its own frames say: shows what became of its state.
  void compare_server_with_itself() {
    note("made again from tick " + std::to_string(report_.remade_from_tick) +
         ", the server's own digests differ from tick " + std::to_string(*parted_tick_) + " on");
    if (made_later_.empty()) return;
    report_.values_tick = finding_.later->tick;
    compare(*finding_.later->state, made_later_);
    note("values under 'client' are those of the tick made again");
  }

  void compare(std::span<const std::byte> server, std::span<const std::byte> client) {
    if (client.empty()) return;
    auto compared = solver::compare_encodings(server, client, kReportedValuesMax);
    if (!compared.ok()) return note("the client's state is none: " + error_words(compared.error()));
    report_.differences = compared.value().count;
    report_.objects = compared.value().objects;
    for (const solver::EncodedDifference& difference : compared.value().first)
      report_.values.push_back(reported(difference, *finding_.room->scene));
    if (!compared.value().first.empty()) first_ = compared.value().first.front();
  }

  /// Traces the tick of the server once more, with the fields of the first object that differs.
  void find_phase() {
    solver::StepTrace trace;
    trace.wants_fields = first_.object();
    simulation_->restore(before_);
    simulation_->trace_state(trace);
    if (!simulation_->step_traced(inputs(finding_.tick), trace).ok()) return;
    const auto points = phases_that_write(trace, first_.object(), first_.field);
    for (const solver::TracePoint& point : points)
      report_.written_in.push_back(solver::point_text(point));
    const bool one_bit = report_.differences == 1 && report_.values.front().bits == 1;
    report_.phase = points.empty() || one_bit ? solver::phase_name(solver::Phase::kState)
                                              : report_.written_in.front();
    if (one_bit) {
      report_.phase_reason =
          "one bit of one number: as a bit that flips in memory after the tick; arithmetic spreads";
    } else if (points.empty()) {
      report_.phase_reason =
          "no phase of the tick writes this number: the host or the memory changed it";
    } else {
      report_.phase_reason = "the first phase of the tick that writes this number, of " +
                             std::to_string(points.size());
    }
  }

  void check_client() {
    if (!finding_.missing.empty()) note("the client's state is not here: " + finding_.missing);
    if (finding_.client_state.empty()) return;
    const auto digest = solver::digest_encoding(finding_.client_state);
    if (!digest) return;
    if (*digest != finding_.client_digest) {
      note("the client said 0x" + protocol::hex16(finding_.client_digest) +
           ", but its state has 0x" + protocol::hex16(*digest) +
           ": it lies, or its memory changes by itself");
    }
    auto scratch = scenes::Simulation::create(*finding_.room->scene);
    if (!scratch.ok()) return;
    if (const solver::Error error = scratch.value().decode(finding_.client_state); !error.ok())
      note("no world can come into the client's state: " + error_words(error));
  }

  void judge() {
    const ReplicaVotes& votes = report_.votes;
    report_.server_suspect = parted_tick_.has_value() || votes.against_server();
    if (parted_tick_) {
      report_.verdict = report_.remade_digest == report_.client_digest
                            ? "the server: made again, the tick is as the client has it"
                            : "the server: made again, its own tick comes out otherwise";
    } else if (votes.against_server()) {
      report_.verdict = "the server is suspect: it makes the tick again as it did, but " +
                        std::to_string(votes.largest_other) + " of " +
                        std::to_string(votes.replicas) +
                        " replicas agree with each other and not with it";
    } else if (report_.remade_digest) {
      report_.verdict = "the client: made again, the server's tick comes out as it was";
    } else {
      report_.verdict = "not known: the tick could not be made again";
    }
    if (!report_.is_first)
      note("an earlier tick may differ already: the client said nothing of it");
  }

  const Finding& finding_;
  DesyncReport report_;
  std::optional<scenes::Simulation> simulation_;
  scenes::Simulation::Saved before_;   ///< The server's state before the tick.
  std::vector<std::byte> made_;        ///< And after it, made again.
  std::vector<std::byte> made_later_;  ///< Of the tick of finding_.later.
  std::optional<std::uint64_t>
      parted_tick_;  ///< From which the server's digests are not its steps'.
  solver::EncodedDifference first_;
};

}  // namespace

DesyncReport investigate(const Finding& finding) {
  return Investigation(finding).run();
}

std::string report_line(const DesyncReport& report) {
  std::string line =
      "desync at tick " + std::to_string(report.tick) + (report.is_first ? "" : " or before");
  if (!report.values.empty()) {
    const ReportedValue& value = report.values.front();
    line += ": " + value.object + (value.name.empty() ? "" : " '" + value.name + "'") +
            (value.field.empty() ? "" : " " + value.field) + ": " + value.server +
            " on the server, " + value.client + " on the client";
    if (report.differences > 1) line += ", and " + std::to_string(report.differences - 1) + " more";
  }
  return line + (report.server_suspect ? "; the server is suspect" : "");
}

}  // namespace cycloid::server
