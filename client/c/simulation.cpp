#include <optional>
#include <utility>

#include "client/c/guard.hpp"
#include "protocol/little_endian.hpp"
#include "scenes/catalogue.hpp"

using namespace cycloid;
using client::failed;
using client::guarded;

struct cycloid_simulation {
  scenes::Scene scene;
  std::uint64_t scene_digest;
  scenes::Simulation simulation;
  std::vector<scenes::SeatInput> inputs;
};

struct cycloid_saved {
  std::uint64_t scene_digest = 0;
  scenes::Simulation::Saved state;
};

static cycloid_status make_simulation(const char* name, cycloid_simulation*& out) {
  scenes::Loaded loaded = scenes::load(name);
  if (!loaded.scene) return client::no_scene(name, loaded);
  auto simulation = scenes::Simulation::create(*loaded.scene);
  if (!simulation.ok()) {
    return failed(CYCLOID_SCENE, std::string(name) + ": cannot run: " + simulation.error().field);
  }
  const std::uint64_t digest = scenes::scene_digest(*loaded.scene);
  std::vector<scenes::SeatInput> inputs(static_cast<std::size_t>(simulation.value().seats()));
  out = new cycloid_simulation{std::move(*loaded.scene), digest, std::move(simulation.value()),
                               std::move(inputs)};
  return CYCLOID_OK;
}

/// One input for each seat, as far apart as the caller's struct is long; false where that is too
/// short, or not the same for all.
static bool read_inputs(const cycloid_input* from, std::vector<scenes::SeatInput>& into) {
  const std::uint32_t stride = into.empty() ? 0 : from->struct_bytes;
  const auto* at = reinterpret_cast<const unsigned char*>(from);
  for (scenes::SeatInput& input : into) {
    cycloid_input known;
    std::memcpy(&known, at, sizeof known);
    if (known.struct_bytes < sizeof known || known.struct_bytes != stride) return false;
    input = client::from_c(known);
    at += stride;
  }
  return true;
}

cycloid_status cycloid_simulation_create(const char* scene, cycloid_simulation** out) {
  if (out == nullptr) return failed(CYCLOID_INVALID, "out: null");
  *out = nullptr;
  if (scene == nullptr) return failed(CYCLOID_INVALID, "scene: null");
  return guarded([&] { return make_simulation(scene, *out); });
}

void cycloid_simulation_destroy(cycloid_simulation* simulation) {
  delete simulation;
}

uint32_t cycloid_simulation_seats(const cycloid_simulation* simulation) {
  return simulation == nullptr ? 0 : static_cast<uint32_t>(simulation->inputs.size());
}

uint64_t cycloid_simulation_tick(const cycloid_simulation* simulation) {
  return simulation == nullptr ? 0 : simulation->simulation.tick();
}

uint64_t cycloid_simulation_digest(const cycloid_simulation* simulation) {
  return simulation == nullptr ? 0 : simulation->simulation.digest();
}

cycloid_status cycloid_simulation_step(cycloid_simulation* simulation, const cycloid_input* inputs,
                                       uint32_t count) {
  if (simulation == nullptr) return failed(CYCLOID_INVALID, "simulation: null");
  return guarded([&] {
    const std::size_t seats = simulation->inputs.size();
    if (count != seats) {
      return failed(CYCLOID_INVALID, "count: " + std::to_string(count) + ", the scene has " +
                                         std::to_string(seats) + " seats");
    }
    if (inputs == nullptr && count != 0) return failed(CYCLOID_INVALID, "inputs: null");
    if (!read_inputs(inputs, simulation->inputs))
      return failed(CYCLOID_INVALID, "inputs: struct_bytes");
    const solver::Error error = simulation->simulation.step(simulation->inputs);
    if (error.ok()) return cycloid_status{CYCLOID_OK};
    return failed(CYCLOID_STEP, std::string(solver::code_name(error.code)) + " " + error.field);
  });
}

cycloid_status cycloid_simulation_scripted_input(const cycloid_simulation* simulation,
                                                 uint32_t seat, uint64_t tick, cycloid_input* out) {
  if (simulation == nullptr) return failed(CYCLOID_INVALID, "simulation: null");
  if (out == nullptr || out->struct_bytes < sizeof(cycloid_input))
    return failed(CYCLOID_INVALID, "out: null, or struct_bytes");
  if (seat >= simulation->inputs.size()) return failed(CYCLOID_INVALID, "seat: no such seat");
  return guarded([&] {
    const auto said = scenes::scripted_input(simulation->scene, static_cast<int>(seat), tick);
    std::copy(said.axes.begin(), said.axes.end(), out->axes);
    out->buttons = said.buttons;
    return cycloid_status{CYCLOID_OK};
  });
}

cycloid_status cycloid_simulation_save(const cycloid_simulation* simulation,
                                       cycloid_saved** saved) {
  if (simulation == nullptr) return failed(CYCLOID_INVALID, "simulation: null");
  if (saved == nullptr) return failed(CYCLOID_INVALID, "saved: null");
  return guarded([&] {
    if (*saved == nullptr) *saved = new cycloid_saved;
    (*saved)->scene_digest = simulation->scene_digest;
    simulation->simulation.save((*saved)->state);
    return cycloid_status{CYCLOID_OK};
  });
}

cycloid_status cycloid_simulation_restore(cycloid_simulation* simulation,
                                          const cycloid_saved* saved) {
  if (simulation == nullptr) return failed(CYCLOID_INVALID, "simulation: null");
  if (saved == nullptr) return failed(CYCLOID_INVALID, "saved: null");
  if (saved->scene_digest != simulation->scene_digest)
    return failed(CYCLOID_INVALID, "saved: of another scene");
  return guarded([&] {
    simulation->simulation.restore(saved->state);
    return cycloid_status{CYCLOID_OK};
  });
}

void cycloid_saved_destroy(cycloid_saved* saved) {
  delete saved;
}

cycloid_status cycloid_simulation_encode(const cycloid_simulation* simulation, uint8_t* bytes,
                                         uint32_t capacity, uint32_t* count) {
  if (simulation == nullptr) return failed(CYCLOID_INVALID, "simulation: null");
  return guarded([&] {
    std::vector<std::byte> state;
    simulation->simulation.encode(state);
    std::vector<std::byte> all;
    all.reserve(sizeof(simulation->scene_digest) + state.size());
    protocol::append_little(simulation->scene_digest, all);
    all.insert(all.end(), state.begin(), state.end());
    return client::copy_out(all, bytes, capacity, count);
  });
}

cycloid_status cycloid_simulation_decode(cycloid_simulation* simulation, const uint8_t* bytes,
                                         uint32_t count) {
  if (simulation == nullptr) return failed(CYCLOID_INVALID, "simulation: null");
  if (bytes == nullptr) return failed(CYCLOID_INVALID, "bytes: null");
  return guarded([&] {
    protocol::LittleReader reader{std::as_bytes(std::span(bytes, count))};
    const auto scene_digest = reader.take<std::uint64_t>();
    if (reader.failed) return failed(CYCLOID_STEP, "bytes: no state");
    if (scene_digest != simulation->scene_digest)
      return failed(CYCLOID_STEP, "bytes: of another scene");
    const solver::Error error = simulation->simulation.decode(reader.bytes);
    if (error.ok()) return cycloid_status{CYCLOID_OK};
    return failed(CYCLOID_STEP, std::string(solver::code_name(error.code)) + " " + error.field);
  });
}

cycloid_status cycloid_simulation_read_poses(const cycloid_simulation* simulation,
                                             cycloid_pose* poses, uint32_t capacity,
                                             uint32_t* count) {
  if (simulation == nullptr) return failed(CYCLOID_INVALID, "simulation: null");
  return guarded([&] {
    return client::copy_out(client::to_c(simulation->simulation.poses()), poses, capacity, count);
  });
}
