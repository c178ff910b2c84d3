#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

#include "client/c/cycloid.h"
#include "scenes/catalogue.hpp"
#include "tests/client/served.hpp"

namespace {

/// While it is set, this thread finds no memory.
thread_local bool no_memory = false;

void* allocate(std::size_t bytes) {
  void* block = no_memory ? nullptr : std::malloc(bytes == 0 ? 1 : bytes);
  if (block == nullptr) throw std::bad_alloc();
  return block;
}

}  // namespace

// Of this program, and so of the library under test: it finds them here.
void* operator new(std::size_t bytes) {
  return allocate(bytes);
}
void* operator new[](std::size_t bytes) {
  return allocate(bytes);
}
void operator delete(void* block) noexcept {
  std::free(block);
}
void operator delete[](void* block) noexcept {
  std::free(block);
}
void operator delete(void* block, std::size_t) noexcept {
  std::free(block);
}
void operator delete[](void* block, std::size_t) noexcept {
  std::free(block);
}

namespace cycloid::client {
namespace {

std::string reason_of_last() {
  std::array<char, 4096> text{};
  EXPECT_LE(cycloid_last_error(text.data(), text.size()), text.size());
  return text.data();
}

template <auto Destroy>
struct Destroying {
  template <class Handle>
  void operator()(Handle* handle) const {
    Destroy(handle);
  }
};
using Offline = std::unique_ptr<cycloid_simulation, Destroying<cycloid_simulation_destroy>>;
using Player = std::unique_ptr<cycloid_client, Destroying<cycloid_client_destroy>>;

Offline offline(const char* scene) {
  cycloid_simulation* made = nullptr;
  EXPECT_EQ(cycloid_simulation_create(scene, &made), CYCLOID_OK) << reason_of_last();
  return Offline(made);
}

Player player(std::uint16_t port) {
  cycloid_client_options options{};
  options.struct_bytes = sizeof(options);
  EXPECT_EQ(cycloid_client_options_init(&options), CYCLOID_OK);
  options.scene = "half-pipe";
  options.port = port;
  options.scripted = 1;
  cycloid_client* made = nullptr;
  EXPECT_EQ(cycloid_client_create(&options, &made), CYCLOID_OK) << reason_of_last();
  return Player(made);
}

cycloid_client_state state_of(const cycloid_client* client) {
  cycloid_client_state state{};
  state.struct_bytes = sizeof(state);
  EXPECT_EQ(cycloid_client_read_state(client, &state), CYCLOID_OK);
  return state;
}

std::vector<cycloid_pose> poses_at(const cycloid_client* client, double tick) {
  std::uint32_t count = 0;
  cycloid_client_read_poses_at(client, tick, nullptr, 0, &count);
  std::vector<cycloid_pose> poses(count);
  EXPECT_EQ(cycloid_client_read_poses_at(client, tick, poses.data(), count, &count), CYCLOID_OK);
  return poses;
}

/// The structs of a header that is newer than the library.
struct NewerInput {
  cycloid_input known;
  std::uint64_t more;
};
struct NewerState {
  cycloid_client_state known;
  std::uint64_t more;
};
struct NewerOptions {
  cycloid_client_options known;
  std::uint64_t more;
};

TEST(CAbiCallers, NewerOnesStructsAreLongerAndTheLibraryGoesByWhatItKnows) {
  const Offline right = offline("half-pipe");
  const Offline world = offline("half-pipe");
  const std::uint32_t seats = cycloid_simulation_seats(world.get());
  ASSERT_GT(seats, 1u);
  std::vector<cycloid_input> inputs(seats);
  std::vector<NewerInput> newer(seats);
  for (std::uint64_t tick = 1; tick <= 30; ++tick) {
    for (std::uint32_t seat = 0; seat < seats; ++seat) {
      inputs[seat].struct_bytes = sizeof(cycloid_input);
      newer[seat] = {{sizeof(NewerInput), {}, 0, 0}, ~std::uint64_t{0}};
      ASSERT_EQ(cycloid_simulation_scripted_input(right.get(), seat, tick, &inputs[seat]),
                CYCLOID_OK);
      ASSERT_EQ(cycloid_simulation_scripted_input(world.get(), seat, tick, &newer[seat].known),
                CYCLOID_OK)
          << reason_of_last();
      EXPECT_EQ(newer[seat].more, ~std::uint64_t{0});
    }
    ASSERT_EQ(cycloid_simulation_step(right.get(), inputs.data(), seats), CYCLOID_OK);
    ASSERT_EQ(cycloid_simulation_step(world.get(), &newer[0].known, seats), CYCLOID_OK)
        << reason_of_last();
  }
  EXPECT_EQ(cycloid_simulation_digest(world.get()), cycloid_simulation_digest(right.get()));

  NewerOptions options{};
  options.known.struct_bytes = sizeof(options);
  options.more = 7;
  ASSERT_EQ(cycloid_client_options_init(&options.known), CYCLOID_OK);
  EXPECT_EQ(options.known.struct_bytes, sizeof(options));
  EXPECT_EQ(options.more, 7u);
  options.known.scene = "half-pipe";
  options.known.port = 1;
  cycloid_client* made = nullptr;
  ASSERT_EQ(cycloid_client_create(&options.known, &made), CYCLOID_OK) << reason_of_last();
  const Player client(made);
  EXPECT_EQ(cycloid_client_send_input(client.get(), &newer[0].known), CYCLOID_OK);
  NewerState state{};
  state.known.struct_bytes = sizeof(state);
  state.more = 9;
  ASSERT_EQ(cycloid_client_read_state(client.get(), &state.known), CYCLOID_OK);
  EXPECT_EQ(state.known.seat, CYCLOID_SPECTATOR);
  EXPECT_EQ(state.more, 9u);
}

TEST(CAbiCallers, InputsOfUnequalOrTooSmallSizesAreRefused) {
  const Offline world = offline("half-pipe");
  const std::uint32_t seats = cycloid_simulation_seats(world.get());
  const std::uint64_t digest = cycloid_simulation_digest(world.get());
  for (const std::uint32_t wrong : {0u, 15u, 24u, 0xffffffffu}) {
    std::vector<cycloid_input> inputs(seats);
    for (cycloid_input& input : inputs) input.struct_bytes = sizeof(cycloid_input);
    inputs.back().struct_bytes = wrong;
    EXPECT_EQ(cycloid_simulation_step(world.get(), inputs.data(), seats), CYCLOID_INVALID);
    EXPECT_EQ(reason_of_last(), "inputs: struct_bytes");
    cycloid_input out{};
    out.struct_bytes = 15;
    EXPECT_EQ(cycloid_simulation_scripted_input(world.get(), 0, 1, &out), CYCLOID_INVALID);
  }
  EXPECT_EQ(cycloid_simulation_digest(world.get()), digest);
}

TEST(CAbiCallers, BytesOfAnotherScenesStateAreRefusedAndChangeNothing) {
  const Offline arch = offline("arch-3d");
  const Offline wall = offline("wall");
  std::uint32_t count = 0;
  EXPECT_EQ(cycloid_simulation_encode(wall.get(), nullptr, 0, &count), CYCLOID_BUFFER);
  std::vector<std::uint8_t> bytes(count);
  ASSERT_EQ(cycloid_simulation_encode(wall.get(), bytes.data(), count, &count), CYCLOID_OK);
  const std::uint64_t digest = cycloid_simulation_digest(arch.get());
  EXPECT_EQ(cycloid_simulation_decode(arch.get(), bytes.data(), count), CYCLOID_STEP);
  EXPECT_EQ(reason_of_last(), "bytes: of another scene");
  EXPECT_EQ(cycloid_simulation_digest(arch.get()), digest);
  EXPECT_EQ(cycloid_simulation_decode(wall.get(), bytes.data(), count), CYCLOID_OK);
  for (const std::uint32_t cut : {0u, 7u, 8u, count - 1})
    EXPECT_EQ(cycloid_simulation_decode(wall.get(), bytes.data(), cut), CYCLOID_STEP) << cut;
}

TEST(CAbiCallers, AreToldThatThereIsNoMemory) {
  const Player client = player(1);
  cycloid_simulation* world = nullptr;
  std::uint32_t count = 0;
  no_memory = true;
  const cycloid_status not_yet = cycloid_client_poll(client.get(), 0);
  const cycloid_status no_token = cycloid_client_read_resume(client.get(), nullptr, 0, &count);
  const cycloid_status none = cycloid_simulation_create("half-pipe", &world);
  no_memory = false;
  EXPECT_EQ(not_yet, CYCLOID_STATE);
  EXPECT_EQ(no_token, CYCLOID_STATE);
  EXPECT_EQ(none, CYCLOID_MEMORY);
  EXPECT_EQ(world, nullptr);
}

TEST(CAbiCallers, ReadPosesAtATimeBetweenTwoStatesThatWereShown) {
  server::ServeOptions serving;
  serving.scene = std::move(*scenes::find("half-pipe").scene);
  Served served(std::move(serving));
  const Player client = player(served.port());
  EXPECT_EQ(cycloid_client_read_poses_at(client.get(), std::nan(""), nullptr, 0, nullptr),
            CYCLOID_INVALID);
  EXPECT_EQ(reason_of_last(), "tick: not a number");
  EXPECT_TRUE(poses_at(client.get(), 3.0).empty());
  ASSERT_EQ(cycloid_client_connect(client.get()), CYCLOID_OK);
  std::map<std::uint64_t, std::vector<cycloid_pose>> shown;
  const auto deadline = std::chrono::steady_clock::now() + kDeadline;
  while (shown.size() < 5 && std::chrono::steady_clock::now() < deadline) {
    ASSERT_EQ(cycloid_client_poll(client.get(), 20), CYCLOID_OK);
    const cycloid_client_state state = state_of(client.get());
    if (state.phase != CYCLOID_PHASE_RUNNING || state.tick < 5) continue;
    std::uint32_t count = 0;
    cycloid_client_read_poses(client.get(), nullptr, 0, &count);
    std::vector<cycloid_pose>& poses = shown[state.predicted_tick];
    poses.resize(count);
    ASSERT_EQ(cycloid_client_read_poses(client.get(), poses.data(), count, &count), CYCLOID_OK);
  }
  ASSERT_EQ(shown.size(), 5u);
  const auto& [later_tick, later] = *shown.rbegin();
  const auto& [earlier_tick, earlier] = *std::next(shown.rbegin());
  const double middle = 0.5 * static_cast<double>(earlier_tick + later_tick);
  const std::vector<cycloid_pose> between = poses_at(client.get(), middle);
  const std::vector<cycloid_pose> newest = poses_at(client.get(), static_cast<double>(later_tick));
  ASSERT_EQ(between.size(), later.size());
  ASSERT_EQ(newest.size(), later.size());
  float moved = 0.0f;
  for (std::size_t i = 0; i < later.size(); ++i) {
    EXPECT_EQ(newest[i].index, later[i].index);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float from = earlier[i].position[axis];
      const float to = later[i].position[axis];
      moved = std::max(moved, std::abs(to - from));
      EXPECT_NEAR(between[i].position[axis], 0.5f * (from + to), 1e-4f);
      EXPECT_NEAR(newest[i].position[axis], to, 1e-5f);
    }
  }
  EXPECT_GT(moved, 1e-3f) << "nothing moves: this shows nothing";
  EXPECT_EQ(poses_at(client.get(), -std::numeric_limits<double>::infinity()).size(), later.size());
  EXPECT_EQ(poses_at(client.get(), std::numeric_limits<double>::infinity()).size(), later.size());
}

}  // namespace
}  // namespace cycloid::client
