#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <utility>

#include "client/c/guard.hpp"
#include "client/replica/body_changes.hpp"
#include "client/replica/interpolator.hpp"
#include "client/token_text.hpp"
#include "client/visit.hpp"
#include "scenes/catalogue.hpp"

using namespace cycloid;
using client::failed;
using client::guarded;

namespace {

/// Events that wait to be read; what comes beyond pushes the oldest out.
constexpr std::size_t kEventsWaitingMax = 4096;

/// Where the fields of the options begin that older callers may not have.
constexpr std::size_t kOptionsFieldsAt[] = {
    offsetof(cycloid_client_options, scene),
    offsetof(cycloid_client_options, name),
    offsetof(cycloid_client_options, room),
    offsetof(cycloid_client_options, token),
    offsetof(cycloid_client_options, resume),
    offsetof(cycloid_client_options, resume_bytes),
    offsetof(cycloid_client_options, port),
    offsetof(cycloid_client_options, seat),
    offsetof(cycloid_client_options, profile),
    offsetof(cycloid_client_options, predict_ticks),
    offsetof(cycloid_client_options, reconnect_deadline_ms),
    offsetof(cycloid_client_options, ticks),
    offsetof(cycloid_client_options, workers),
    offsetof(cycloid_client_options, scripted),
};

}  // namespace

struct cycloid_client {
  client::JoinOptions options;
  scenes::SeatInput input;
  client::BodyChanges bodies;
  std::vector<scenes::Pose> poses;
  client::Interpolator states;
  std::deque<cycloid_event> events;
  std::uint64_t events_lost = 0;
  std::unique_ptr<client::Visit> visit;  ///< Last, so first to go: its callbacks use the rest.

  void add(std::uint32_t kind, std::uint64_t tick, std::uint32_t subject, std::uint64_t value) {
    if (events.size() == kEventsWaitingMax) {
      events.pop_front();
      ++events_lost;
    }
    events.push_back({tick, value, kind, subject});
  }
};

namespace {

cycloid_client_options default_options() {
  cycloid_client_options options{};
  options.struct_bytes = sizeof(options);
  options.mode = CYCLOID_MODE_LOCKSTEP;
  options.host = "127.0.0.1";
  options.seat = CYCLOID_ANY_SEAT;
  options.profile = CYCLOID_PROFILE_EXACT;
  options.workers = 1;
  return options;
}

/// Whether it can be the size of some version's options: half of a pointer is none.
bool is_options_size(std::uint32_t bytes) {
  return bytes >= sizeof(cycloid_client_options) ||
         std::ranges::find(kOptionsFieldsAt, bytes) != std::end(kOptionsFieldsAt);
}

std::string text_of(const char* text) {
  return text == nullptr ? "" : text;
}

/// What is wrong with what only the C interface has, or "": the rest is client::mistake_of.
std::string mistake_in_c(const cycloid_client_options& options) {
  if (options.scene == nullptr) return "scene: null";
  if (options.host == nullptr) return "host: null";
  if (options.token != nullptr && !client::token_from_text(options.token))
    return "token: no base64url of at most 512 bytes";
  if (options.resume != nullptr && options.resume_bytes != protocol::kResumeBytes)
    return "resume_bytes: not 32";
  return "";
}

/// 0 where it does not fit. What is narrower in C++ than in C must not be 0, so mistake_of says so.
template <class Narrow>
Narrow narrow(std::uint32_t wide) {
  return std::in_range<Narrow>(wide) ? static_cast<Narrow>(wide) : Narrow{0};
}

client::JoinOptions to_join(const cycloid_client_options& options) {
  client::JoinOptions join;
  join.mode = protocol::Mode{narrow<std::uint8_t>(options.mode)};
  join.host = options.host;
  join.port = narrow<std::uint16_t>(options.port);
  join.name = text_of(options.name);
  join.room = text_of(options.room);
  if (options.token != nullptr) join.token = *client::token_from_text(options.token);
  if (options.resume != nullptr) {
    const auto bytes = std::as_bytes(std::span(options.resume, options.resume_bytes));
    join.resume.assign(bytes.begin(), bytes.end());
  }
  join.seat_wish = options.seat;
  join.profile = protocol::Profile{narrow<std::uint8_t>(options.profile)};
  join.predict_ticks = options.predict_ticks;
  join.reconnect.on = options.reconnect_deadline_ms != 0;
  join.reconnect.deadline = std::chrono::milliseconds(options.reconnect_deadline_ms);
  join.reconnect.seed =
      static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
  join.ticks = options.ticks;
  join.workers = narrow<int>(options.workers);
  return join;
}

void note_frame(cycloid_client& to, const protocol::InputFrame& frame) {
  for (const protocol::FrameEvent& event : frame.events)
    to.add(static_cast<std::uint32_t>(event.kind), frame.tick, event.seat, 0);
  for (const protocol::FrameChange& change : frame.changes)
    to.add(CYCLOID_EVENT_INPUT_DELAY, frame.tick, 0, change.value);
}

/// The state to show, and the bodies that came and went since the one before.
void note_bodies(cycloid_client& to, const client::Follower& follower) {
  const std::uint64_t tick = follower.progress().last_tick;
  to.poses = follower.poses();
  to.states.add(std::max(tick, follower.simulation().tick()), to.poses);
  for (const client::BodyChange& change : to.bodies.compare(to.poses)) {
    to.add(change.created ? CYCLOID_EVENT_BODY_CREATED : CYCLOID_EVENT_BODY_DESTROYED, tick,
           change.index, change.generation);
  }
}

cycloid_status make_client(const cycloid_client_options& options, cycloid_client*& out) {
  scenes::Loaded loaded = scenes::load(options.scene);
  if (!loaded.scene) return client::no_scene(options.scene, loaded);
  auto made = std::make_unique<cycloid_client>();
  cycloid_client& client = *made;
  client.options = to_join(options);
  client.options.scene = std::move(*loaded.scene);
  if (const std::string mistake = client::mistake_of(client.options); !mistake.empty())
    return failed(CYCLOID_INVALID, mistake);
  if (options.scripted == 0) {
    client.options.input = [&client](int, std::uint64_t) { return client.input; };
  }
  client.options.on_frame = [&client](const auto& frame) { note_frame(client, frame); };
  client.options.on_progress = [&client](client::Follower& at) { note_bodies(client, at); };
  client.options.on_notice = [&client](const protocol::RoomNotice& notice) {
    client.add(CYCLOID_EVENT_NOTICE, notice.tick, static_cast<std::uint32_t>(notice.kind),
               notice.value);
  };
  out = made.release();
  return CYCLOID_OK;
}

std::uint32_t phase_of(const client::Visit& visit) {
  if (visit.over()) return CYCLOID_PHASE_OVER;
  switch (visit.follower()->progress().phase) {
    case client::Phase::kLoading:
      return CYCLOID_PHASE_LOADING;
    case client::Phase::kRunning:
      return CYCLOID_PHASE_RUNNING;
    default:  // The connection that is over is followed by another.
      return CYCLOID_PHASE_CONNECTING;
  }
}

cycloid_client_state state_of(const cycloid_client& of) {
  const client::Visit& visit = *of.visit;
  const client::JoinReport report = visit.report();
  const client::Progress& progress = report.progress;
  cycloid_client_state state{};
  state.struct_bytes = sizeof(state);
  state.phase = phase_of(visit);
  if (visit.over()) state.end = static_cast<std::uint32_t>(report.end) + 1;
  if (progress.refused) state.refusal = static_cast<std::uint32_t>(progress.refused->code);
  state.seat = progress.seat;
  state.lead_ticks = progress.lead_ticks;
  state.early_ticks = progress.early_ticks;
  const client::Follower* follower = visit.follower();
  state.tick_rate_millihertz = follower == nullptr ? 0 : follower->tick_rate_millihertz();
  state.tick = progress.last_tick;
  state.predicted_tick = std::max(state.tick, of.states.newest_tick());
  state.digest = report.final_digest;
  state.frames = progress.frames;
  state.digests_compared = progress.digests_compared;
  state.mismatches = progress.mismatches;
  state.resyncs = progress.resyncs;
  state.inputs_sent = progress.inputs_sent;
  state.inputs_replaced = progress.inputs_replaced;
  state.rollbacks = report.prediction.rollbacks;
  state.ticks_resimulated = report.prediction.resimulated;
  state.reconnects = report.reconnects;
  return state;
}

static_assert(static_cast<int>(client::End::kTicks) + 1 == CYCLOID_END_TICKS);
static_assert(static_cast<int>(client::End::kFailed) + 1 == CYCLOID_END_FAILED);
static_assert(static_cast<int>(protocol::EventKind::kResume) == CYCLOID_EVENT_RESUME);

}  // namespace

cycloid_status cycloid_client_options_init(cycloid_client_options* options) {
  if (options == nullptr) return failed(CYCLOID_INVALID, "options: null");
  if (!is_options_size(options->struct_bytes)) return failed(CYCLOID_INVALID, "struct_bytes");
  client::copy_known(default_options(), *options);
  return CYCLOID_OK;
}

cycloid_status cycloid_client_create(const cycloid_client_options* options, cycloid_client** out) {
  if (out == nullptr) return failed(CYCLOID_INVALID, "out: null");
  *out = nullptr;
  if (options == nullptr) return failed(CYCLOID_INVALID, "options: null");
  if (!is_options_size(options->struct_bytes)) return failed(CYCLOID_INVALID, "struct_bytes");
  return guarded([&] {
    cycloid_client_options all = default_options();
    client::copy_known(*options, all);
    if (const std::string mistake = mistake_in_c(all); !mistake.empty())
      return failed(CYCLOID_INVALID, mistake);
    return make_client(all, *out);
  });
}

void cycloid_client_destroy(cycloid_client* client) {
  guarded([&] {
    delete client;
    return cycloid_status{CYCLOID_OK};
  });
}

cycloid_status cycloid_client_connect(cycloid_client* client) {
  if (client == nullptr) return failed(CYCLOID_INVALID, "client: null");
  if (client->visit != nullptr) return failed(CYCLOID_STATE, "connected once already");
  return guarded([&] {
    client->visit = std::make_unique<client::Visit>(client->options);
    return cycloid_status{CYCLOID_OK};
  });
}

cycloid_status cycloid_client_poll(cycloid_client* client, uint32_t wait_ms) {
  if (client == nullptr) return failed(CYCLOID_INVALID, "client: null");
  if (client->visit == nullptr) return failed(CYCLOID_STATE, "not connected yet");
  return guarded([&] {
    client->visit->poll(std::chrono::milliseconds(wait_ms));
    return cycloid_status{CYCLOID_OK};
  });
}

cycloid_status cycloid_client_send_input(cycloid_client* client, const cycloid_input* input) {
  if (client == nullptr) return failed(CYCLOID_INVALID, "client: null");
  if (input == nullptr || input->struct_bytes < sizeof(cycloid_input))
    return failed(CYCLOID_INVALID, "input: null, or struct_bytes");
  client->input = client::from_c(*input);
  return CYCLOID_OK;
}

cycloid_status cycloid_client_leave(cycloid_client* client) {
  if (client == nullptr) return failed(CYCLOID_INVALID, "client: null");
  if (client->visit == nullptr) return failed(CYCLOID_STATE, "not connected yet");
  return guarded([&] {
    client->visit->stop();
    return cycloid_status{CYCLOID_OK};
  });
}

cycloid_status cycloid_client_read_state(const cycloid_client* client, cycloid_client_state* out) {
  if (client == nullptr) return failed(CYCLOID_INVALID, "client: null");
  if (out == nullptr || out->struct_bytes < sizeof(std::uint32_t))
    return failed(CYCLOID_INVALID, "out: null, or struct_bytes");
  return guarded([&] {
    cycloid_client_state state{};
    state.struct_bytes = sizeof(state);
    state.seat = CYCLOID_SPECTATOR;
    if (client->visit != nullptr) state = state_of(*client);
    client::copy_known(state, *out);
    return cycloid_status{CYCLOID_OK};
  });
}

uint32_t cycloid_client_reason(const cycloid_client* client, char* text, uint32_t capacity) {
  std::uint32_t bytes = 0;
  guarded([&] {
    std::string reason;
    if (client != nullptr && client->visit != nullptr) reason = client->visit->report().reason;
    bytes = client::copy_text(reason, text, capacity);
    return cycloid_status{CYCLOID_OK};
  });
  return bytes;
}

cycloid_status cycloid_client_read_resume(const cycloid_client* client, uint8_t* bytes,
                                          uint32_t capacity, uint32_t* count) {
  if (client == nullptr) return failed(CYCLOID_INVALID, "client: null");
  if (client->visit == nullptr || client->visit->resume().empty())
    return failed(CYCLOID_STATE, "the server gave no resume token");
  return guarded([&] { return client::copy_out(client->visit->resume(), bytes, capacity, count); });
}

cycloid_status cycloid_client_read_poses(const cycloid_client* client, cycloid_pose* poses,
                                         uint32_t capacity, uint32_t* count) {
  if (client == nullptr) return failed(CYCLOID_INVALID, "client: null");
  return guarded(
      [&] { return client::copy_out(client::to_c(client->poses), poses, capacity, count); });
}

cycloid_status cycloid_client_read_poses_at(const cycloid_client* client, double tick,
                                            cycloid_pose* poses, uint32_t capacity,
                                            uint32_t* count) {
  if (client == nullptr) return failed(CYCLOID_INVALID, "client: null");
  if (std::isnan(tick)) return failed(CYCLOID_INVALID, "tick: not a number");
  return guarded([&] {
    return client::copy_out(client::to_c(client->states.at(tick)), poses, capacity, count);
  });
}

cycloid_status cycloid_client_read_events(cycloid_client* client, cycloid_event* events,
                                          uint32_t capacity, uint32_t* count) {
  if (client == nullptr) return failed(CYCLOID_INVALID, "client: null");
  if (count == nullptr) return failed(CYCLOID_INVALID, "count: null");
  if (events == nullptr && capacity != 0) return failed(CYCLOID_INVALID, "events: null");
  std::uint32_t taken = 0;
  if (client->events_lost != 0 && capacity != 0) {
    events[taken++] = {client->events.front().tick, client->events_lost, CYCLOID_EVENT_EVENTS_LOST,
                       0};
    client->events_lost = 0;
  }
  for (; taken < capacity && !client->events.empty(); ++taken) {
    events[taken] = client->events.front();
    client->events.pop_front();
  }
  *count = taken;
  return CYCLOID_OK;
}
