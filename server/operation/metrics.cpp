#include "server/operation/metrics.hpp"

#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

#include <sstream>
#include <utility>

namespace cycloid::server {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;

MetricFamily family(const char* name, const char* help, MetricType type) {
  MetricFamily made;
  made.name = name;
  made.help = help;
  made.type = type;
  return made;
}

ClientMetric labelled(const std::string& name, const std::string& value) {
  ClientMetric metric;
  if (!name.empty()) metric.label.push_back({name, value});
  return metric;
}

void put(ClientMetric& metric, MetricType type, double value) {
  if (type == MetricType::Counter) metric.counter.value = value;
  if (type == MetricType::Gauge) metric.gauge.value = value;
}

void put(ClientMetric& metric, const DurationMeter& durations) {
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < DurationMeter::kBounds.size(); ++i) {
    below += durations.in_bucket(i);
    metric.histogram.bucket.push_back(
        {below, static_cast<double>(DurationMeter::kBounds[i]) * 1e-9});
  }
  // Written while this reads: the total is never less than what is in the buckets.
  metric.histogram.sample_count = std::max(below, durations.count());
  metric.histogram.sample_sum = static_cast<double>(durations.sum_ns()) * 1e-9;
}

/// A number of every room.
struct RoomNumber {
  const char* name;
  const char* help;
  MetricType type;
  Meter RoomMeters::*meter;
  double unit = 1.0;
};

constexpr RoomNumber kRoomNumbers[] = {
    {"cycloid_room_tick", "The last tick made.", MetricType::Gauge, &RoomMeters::tick},
    {"cycloid_room_clients", "Connections in the room.", MetricType::Gauge, &RoomMeters::clients},
    {"cycloid_room_queue_bytes", "Bytes that wait for clients.", MetricType::Gauge,
     &RoomMeters::queue_bytes},
    {"cycloid_room_log_durable", "1, or 0 once the log has ended before the match.",
     MetricType::Gauge, &RoomMeters::durable},
    {"cycloid_room_joins_total", "Clients that were welcomed.", MetricType::Counter,
     &RoomMeters::joined},
    {"cycloid_room_hash_mismatches_total", "Digests of clients that differed.", MetricType::Counter,
     &RoomMeters::desyncs},
    {"cycloid_room_desync_inquiries_skipped_total", "Desyncs beyond a bound, not looked into.",
     MetricType::Counter, &RoomMeters::inquiries_skipped},
    {"cycloid_room_inputs_late_total", "Inputs for ticks already made.", MetricType::Counter,
     &RoomMeters::inputs_late},
    {"cycloid_room_inputs_early_total", "Inputs beyond the window.", MetricType::Counter,
     &RoomMeters::inputs_early},
    {"cycloid_room_inputs_replaced_total", "Seats in ticks that closed without an input of theirs.",
     MetricType::Counter, &RoomMeters::inputs_replaced},
    {"cycloid_room_received_bytes_total", "Bytes of clients.", MetricType::Counter,
     &RoomMeters::bytes_in},
    {"cycloid_room_sent_bytes_total", "Bytes for clients.", MetricType::Counter,
     &RoomMeters::bytes_out},
    {"cycloid_room_catch_up_ticks_total", "Ticks made in one go behind another.",
     MetricType::Counter, &RoomMeters::catch_up_ticks},
    {"cycloid_room_slowed_seconds_total", "Time by which overload or a pause put the match off.",
     MetricType::Counter, &RoomMeters::slowed_ns, 1e-9},
    {"cycloid_room_encodes_total", "States that were encoded, for clients or to be kept.",
     MetricType::Counter, &RoomMeters::encodes},
};

using Rooms = std::vector<std::shared_ptr<HostedRoom>>;

MetricFamily refusals(const Rooms& rooms, const HostMeters& host) {
  MetricFamily made =
      family("cycloid_refusals_total",
             "Connections sent away, by the gate (room \"\") or by a room.", MetricType::Counter);
  const auto add = [&](const std::string& room, const RefusalMeters& meters) {
    for (std::size_t code = 1; code < meters.size(); ++code) {
      if (meters[code].get() == 0) continue;
      ClientMetric metric = labelled("room", room);
      metric.label.push_back({"code", refusal_label(static_cast<protocol::Refusal>(code))});
      put(metric, MetricType::Counter, static_cast<double>(meters[code].get()));
      made.metric.push_back(std::move(metric));
    }
  };
  add("", host.refusals);
  for (const auto& room : rooms) add(room->name(), room->meters().refusals);
  return made;
}

MetricFamily stages(const Rooms& rooms) {
  MetricFamily made =
      family("cycloid_rooms", "Rooms, by where they are in their life.", MetricType::Gauge);
  for (const LifeStage stage :
       {LifeStage::kRunning, LifeStage::kPaused, LifeStage::kDraining, LifeStage::kEnded}) {
    double count = 0.0;
    for (const auto& room : rooms) count += room->stage() == stage ? 1.0 : 0.0;
    ClientMetric metric = labelled("stage", life_stage_name(stage));
    put(metric, MetricType::Gauge, count);
    made.metric.push_back(std::move(metric));
  }
  return made;
}

MetricFamily durations(const char* name, const char* help, const Rooms& rooms,
                       const DurationMeter RoomMeters::*meter) {
  MetricFamily made = family(name, help, MetricType::Histogram);
  for (const auto& room : rooms) {
    ClientMetric metric = labelled("room", room->name());
    put(metric, room->meters().*meter);
    made.metric.push_back(std::move(metric));
  }
  return made;
}

void add_host(const Host& host, std::vector<MetricFamily>& families) {
  const auto add = [&](const char* name, const char* help, MetricType type, double value) {
    MetricFamily made = family(name, help, type);
    ClientMetric metric;
    put(metric, type, value);
    made.metric.push_back(std::move(metric));
    families.push_back(std::move(made));
  };
  const HostMeters& meters = host.meters();
  const auto count = [](const Meter& meter) { return static_cast<double>(meter.get()); };
  add("cycloid_connections", "Open connections.", MetricType::Gauge, count(meters.connections));
  add("cycloid_connections_pending", "Of these, without an accepted hello.", MetricType::Gauge,
      count(meters.pending));
  add("cycloid_connections_accepted_total", "Connections ever.", MetricType::Counter,
      count(meters.accepted));
  add("cycloid_accept_failures_total", "Accepts that failed, such as without descriptors.",
      MetricType::Counter, count(meters.accept_failures));
  add("cycloid_rooms_made_total", "Rooms ever.", MetricType::Counter, count(meters.rooms_made));
  add("cycloid_rooms_ended_total", "Rooms that are over.", MetricType::Counter,
      count(meters.rooms_ended));
  add("cycloid_desync_reports_dropped_total", "Reports over a bound, or refused by the disk.",
      MetricType::Counter, count(meters.reports_dropped));
  add("cycloid_draining", "1 from the first word of a drain on.", MetricType::Gauge,
      host.draining() ? 1.0 : 0.0);
  MetricFamily sync =
      family("cycloid_log_sync_seconds", "Syncs of logs to the disk.", MetricType::Histogram);
  ClientMetric metric;
  put(metric, meters.log_sync);
  sync.metric.push_back(std::move(metric));
  families.push_back(std::move(sync));
}

}  // namespace

std::vector<MetricFamily> HostMetrics::Collect() const {
  const Rooms rooms = host_.rooms();
  std::vector<MetricFamily> families;
  add_host(host_, families);
  families.push_back(stages(rooms));
  families.push_back(refusals(rooms, host_.meters()));
  families.push_back(durations("cycloid_room_tick_lateness_seconds",
                               "From a tick's deadline to its start.", rooms,
                               &RoomMeters::lateness));
  families.push_back(durations("cycloid_room_tick_seconds",
                               "Making a tick: step, digest, record and encoding.", rooms,
                               &RoomMeters::tick_time));
  for (const RoomNumber& number : kRoomNumbers) {
    MetricFamily made = family(number.name, number.help, number.type);
    for (const auto& room : rooms) {
      ClientMetric metric = labelled("room", room->name());
      put(metric, number.type,
          static_cast<double>((room->meters().*number.meter).get()) * number.unit);
      made.metric.push_back(std::move(metric));
    }
    families.push_back(std::move(made));
  }
  return families;
}

std::string HostMetrics::text() const {
  std::ostringstream text;
  prometheus::TextSerializer().Serialize(text, Collect());
  return text.str();
}

const char* refusal_label(protocol::Refusal code) {
  static constexpr const char* kLabels[] = {
      "none",         "protocol_version", "solver_version", "scene_digest",  "seat_taken",
      "no_such_seat", "room_full",        "bad_message",    "too_large",     "too_slow",
      "draining",     "faulted",          "token_invalid",  "token_expired", "token_used",
      "token_scope",  "no_such_room",     "room_locked",    "rate_limited",  "kicked",
      "replaced",     "resume_unknown",   "resync_limit"};
  static_assert(std::size(kLabels) == static_cast<std::size_t>(protocol::kLastRefusal) + 1);
  return kLabels[static_cast<std::size_t>(code)];
}

}  // namespace cycloid::server
