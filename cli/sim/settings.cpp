#include "cli/sim/settings.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "scenes/catalogue.hpp"

namespace cycloid::sim {
namespace {

/// Half of the seeds are without a fault, most others have some of it, one in eight much of it.
class Swarm {
 public:
  explicit Swarm(Random random) : random_(random) {}

  /// 0, or 1 to `usual`, or `usual` to `extreme`.
  std::int64_t draw(std::int64_t usual, std::int64_t extreme) {
    if (random_.one_in(2)) return 0;
    if (random_.one_in(8)) return random_.between(usual, extreme);
    return random_.between(1, usual);
  }
  std::uint32_t rate(std::int64_t usual, std::int64_t extreme) {
    return static_cast<std::uint32_t>(draw(usual, extreme));
  }
  template <class T, std::size_t N>
  T pick(const std::array<T, N>& choices) {
    return choices[random_.below(N)];
  }
  Random& random() { return random_; }

 private:
  Random random_;
};

NetworkSettings draw_network(Swarm swarm) {
  NetworkSettings network;
  network.latency_max_ns = swarm.draw(80, 800) * kMillisecond;
  network.jitter_max_ns = swarm.draw(30, 500) * kMillisecond;
  if (swarm.random().one_in(4)) {
    network.bytes_per_s_min = static_cast<std::uint64_t>(swarm.random().between(4'000, 64'000));
  }
  network.segment_bytes_max = swarm.pick(std::array<std::uint32_t, 6>{1460, 1460, 1460, 64, 7, 1});
  network.ragged = swarm.random().one_in(2);
  network.coalesces = swarm.random().one_in(2);
  network.stall_per_million = swarm.rate(10'000, 100'000);
  network.stall_max_ns = swarm.random().between(200, 3'000) * kMillisecond;
  network.flipping_per_million = swarm.rate(200'000, kMillion);
  network.flip_per_million = static_cast<std::uint32_t>(swarm.random().between(100, 20'000));
  network.blackhole_per_million = swarm.rate(100'000, 500'000);
  network.reset_per_million = swarm.rate(300'000, 900'000);
  network.capacity_bytes = swarm.pick(std::array<std::size_t, 4>{262'144, 262'144, 16'384, 2'048});
  return network;
}

ClientSettings draw_client(Swarm swarm) {
  ClientSettings client;
  client.drift_max_ppm = static_cast<std::int32_t>(swarm.draw(500, 50'000));
  client.ping_ns = swarm.random().between(100, 600) * kMillisecond;
  client.silence_ns = swarm.random().between(1'500, 5'000) * kMillisecond;
  client.zero_window_per_million = swarm.rate(200'000, kMillion);
  client.zero_window_max_ns = swarm.random().between(100, 6'000) * kMillisecond;
  client.half_close_per_million = swarm.rate(100'000, 500'000);
  client.leave_per_million = swarm.rate(200'000, 900'000);
  client.duplicate_per_million = swarm.rate(100'000, 500'000);
  client.desync_per_million = swarm.rate(200'000, 900'000);
  client.storms = swarm.rate(1, 4);
  return client;
}

ServerSettings draw_server(Swarm swarm) {
  ServerSettings server;
  server.pauses = swarm.rate(2, 10);
  server.pause_max_ns = swarm.random().between(20, 3'000) * kMillisecond;
  server.deaths = swarm.rate(1, 4);
  server.power_cuts_of = 500'000;
  server.log = swarm.random().one_in(3) ? server::LogSync::kEveryTick : server::LogSync::kInterval;
  server.sync_interval_ns = swarm.random().between(20, 500) * kMillisecond;
  server.log_queue_bytes_max = swarm.pick(std::array<std::size_t, 3>{1 << 20, 1 << 20, 4096});
  server.stop_on_log_error = swarm.random().one_in(4);
  if (swarm.random().one_in(8)) server.log = server::LogSync::kNone;
  server.keyframe_ticks = static_cast<std::uint64_t>(swarm.random().between(10, 400));
  server.rotations = swarm.rate(2, 8);
  return server;
}

DiskFaults draw_disk(Swarm swarm) {
  DiskFaults disk;
  disk.short_write_per_million = swarm.rate(100'000, 900'000);
  disk.interrupted_per_million = swarm.rate(50'000, 500'000);
  disk.write_error_per_million = swarm.rate(500, 20'000);
  disk.sync_error_per_million = swarm.rate(1'000, 50'000);
  disk.kill_per_million = swarm.rate(1'000, 10'000);
  disk.stall_per_million = swarm.rate(2'000, 20'000);
  disk.stall_ns = swarm.random().between(50, 2'000) * kMillisecond;
  if (swarm.random().one_in(6)) {
    disk.capacity_bytes = static_cast<std::uint64_t>(swarm.random().between(2'000, 60'000));
  }
  return disk;
}

server::Limits draw_limits(Swarm swarm) {
  server::Limits limits;
  limits.messages_per_tick_max = swarm.pick(std::array<std::uint32_t, 4>{64, 64, 16, 4});
  limits.queue_bytes_max = swarm.pick(std::array<std::size_t, 4>{1 << 20, 65'536, 65'536, 8'192});
  limits.handshake = std::chrono::milliseconds(swarm.random().between(1'500, 5'000));
  limits.idle = std::chrono::milliseconds(swarm.random().between(2'000, 6'000));
  limits.catch_up_ticks_max = swarm.pick(std::array<std::uint32_t, 4>{8, 8, 2, 1});
  limits.digest_ticks = swarm.pick(std::array<std::uint64_t, 5>{60, 60, 20, 5, 1});
  limits.snapshot_ticks = swarm.pick(std::array<std::uint64_t, 4>{3, 3, 1, 7});
  limits.input_delay_ticks = static_cast<std::uint32_t>(swarm.random().between(1, 12));
  return limits;
}

/// Who comes in how, and what a thin client is shown.
void draw_admission(Settings& settings, Swarm swarm) {
  using server::TokenPolicy;
  settings.server.tokens =
      swarm.pick(std::array<TokenPolicy, 4>{TokenPolicy::kIgnored, TokenPolicy::kIgnored,
                                            TokenPolicy::kOptional, TokenPolicy::kRequired});
  settings.server.gives_resume_secrets = swarm.random().one_in(2);
  settings.limits.resume = std::chrono::milliseconds(swarm.random().between(500, 8'000));
  settings.quantised_of_million = swarm.rate(500'000, kMillion);
  settings.limits.snapshot_bytes_max =
      swarm.pick(std::array<std::size_t, 4>{1'200, std::size_t{1} << 20, std::size_t{1} << 20, 96});
}

std::string draw_scene(Swarm& swarm) {
  const std::uint64_t choice = swarm.random().below(64);
  if (choice == 0) return "room-200";
  if (choice < 8) return "half-pipe";
  static const std::array<std::string, 4> kSmall = {"vehicle", "stack-10-3d", "character-course",
                                                    "rolling"};
  return choice < 12 ? kSmall[choice - 8] : "tiny";
}

}  // namespace

Settings draw_settings(std::uint64_t seed) {
  const Random root(seed);
  Swarm swarm(root.fork(100));
  Settings settings;
  settings.seed = seed;
  settings.scene = draw_scene(swarm);
  const bool large = settings.scene == "room-200";
  settings.ticks = static_cast<std::uint64_t>(swarm.random().between(300, 900));
  if (large) settings.ticks = 150;
  settings.rooms = swarm.random().one_in(5) && !large ? 2 : 1;
  settings.players = static_cast<std::uint32_t>(swarm.random().between(1, 3));
  settings.spectators = swarm.rate(2, 5);
  settings.hostiles = swarm.rate(2, 8);
  settings.troublemakers = swarm.rate(1, 3);
  settings.snapshots_of_million = swarm.rate(300'000, kMillion);
  settings.any_seat = swarm.random().one_in(2);
  settings.tick_rate_millihertz =
      swarm.pick(std::array<std::uint32_t, 5>{60'000, 60'000, 60'000, 30'000, 128'000});
  settings.limits = draw_limits(Swarm(root.fork(101)));
  settings.network = draw_network(Swarm(root.fork(102)));
  settings.client = draw_client(Swarm(root.fork(103)));
  settings.server = draw_server(Swarm(root.fork(104)));
  settings.disk = draw_disk(Swarm(root.fork(105)));
  draw_admission(settings, Swarm(root.fork(106)));
  settings.server.rewinds = Swarm(root.fork(107)).rate(1, 4);
  settings.spectator_delay_ticks = Swarm(root.fork(108)).rate(60, 300);
  return settings;
}

scenes::Scene tiny_scene() {
  scenes::Scene scene;
  scene.name = "tiny";
  scene.summary = "A floor, three bodies, three seats.";
  scene.gravity = {0.0f, -10.0f, 0.0f};
  scenes::SceneBody floor;
  floor.kind = solver::BodyKind::kStatic;
  floor.shapes.resize(1);
  floor.shapes[0].kind = solver::ShapeKind::kHalfSpace;
  floor.shapes[0].normal = {0.0f, 1.0f, 0.0f};
  scene.bodies.push_back(floor);
  float x = -0.9f;
  for (const char* name : {"left", "middle", "right"}) {
    scenes::SceneBody ball;
    ball.name = name;
    ball.position = {x, 0.5f, 0.0f};
    ball.linear_damping = 1.0f;
    ball.shapes.resize(1);
    ball.shapes[0].kind = solver::ShapeKind::kBall;
    ball.shapes[0].radius = 0.5f;
    ball.shapes[0].points = {{0.0f, 0.0f, 0.0f}};
    scene.bodies.push_back(ball);
    scenes::Seat seat;
    seat.name = name;
    scenes::Control push;
    push.target = name;
    push.value = {20.0f, 0.0f, 0.0f};
    seat.controls.push_back(push);
    scene.seats.push_back(seat);
    x += 0.9f;
  }
  return scene;
}

std::optional<scenes::Scene> scene_of(const std::string& name) {
  if (name == "tiny") return tiny_scene();
  return scenes::load(name).scene;
}

}  // namespace cycloid::sim
