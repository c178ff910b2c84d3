#include <gtest/gtest.h>
#include <stdio.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <sstream>

#include "client/c/cycloid.h"
#include "scenes/catalogue.hpp"
#include "tests/client/served.hpp"
#include "tests/places.hpp"

namespace cycloid::client {
namespace {

struct Output {
  int exit = -1;
  std::string text;
};

/// A command of the shell, to its end.
Output run_shell(const std::string& command) {
  Output output;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> part{};
  for (std::size_t size = 0; (size = fread(part.data(), 1, part.size(), pipe)) != 0;)
    output.text.append(part.data(), size);
  const int status = pclose(pipe);
  output.exit = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return output;
}

/// The interface as it was promised, one line for each call and each field.
std::set<std::string> promised() {
  std::ifstream stream(places::source("tests/client/c_abi.txt"));
  std::set<std::string> lines;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) lines.insert(line);
  return lines;
}

std::set<std::string> promised(const std::string& kind) {
  std::set<std::string> lines;
  for (const std::string& line : promised())
    if (line.starts_with(kind + " ")) lines.insert(line);
  return lines;
}

std::string last_error() {
  std::array<char, 4096> text{};
  EXPECT_LE(cycloid_last_error(text.data(), text.size()), text.size());
  return text.data();
}

TEST(CAbi, ExportsThePromisedCallsAndNothingElse) {
  const Output nm =
      run_shell(places::name_lister() + " -D --defined-only -P '" + places::c_library() + "'");
  ASSERT_EQ(nm.exit, 0) << nm.text;
  std::set<std::string> calls;
  std::istringstream lines(nm.text);
  for (std::string line; std::getline(lines, line);) {
    const std::string symbol = line.substr(0, line.find_first_of(" @"));
    if (symbol != "CYCLOID_1") calls.insert("call " + symbol);  // The name of the version.
  }
  EXPECT_EQ(calls, promised("call"));
}

#define CYCLOID_FIELD(type, field)                                              \
  "field " #type "." #field " " + std::to_string(offsetof(type, field)) + " " + \
      std::to_string(sizeof(type::field))

TEST(CAbi, LaysOutEveryStructAsPromised) {
  static_assert(sizeof(void*) == 8, "the list is of 64-bit targets");
  const std::set<std::string> fields = {
      CYCLOID_FIELD(cycloid_input, struct_bytes),
      CYCLOID_FIELD(cycloid_input, axes),
      CYCLOID_FIELD(cycloid_input, buttons),
      CYCLOID_FIELD(cycloid_input, reserved),
      CYCLOID_FIELD(cycloid_pose, index),
      CYCLOID_FIELD(cycloid_pose, generation),
      CYCLOID_FIELD(cycloid_pose, position),
      CYCLOID_FIELD(cycloid_pose, rotation),
      CYCLOID_FIELD(cycloid_client_options, struct_bytes),
      CYCLOID_FIELD(cycloid_client_options, mode),
      CYCLOID_FIELD(cycloid_client_options, host),
      CYCLOID_FIELD(cycloid_client_options, scene),
      CYCLOID_FIELD(cycloid_client_options, name),
      CYCLOID_FIELD(cycloid_client_options, room),
      CYCLOID_FIELD(cycloid_client_options, token),
      CYCLOID_FIELD(cycloid_client_options, resume),
      CYCLOID_FIELD(cycloid_client_options, resume_bytes),
      CYCLOID_FIELD(cycloid_client_options, port),
      CYCLOID_FIELD(cycloid_client_options, seat),
      CYCLOID_FIELD(cycloid_client_options, profile),
      CYCLOID_FIELD(cycloid_client_options, predict_ticks),
      CYCLOID_FIELD(cycloid_client_options, reconnect_deadline_ms),
      CYCLOID_FIELD(cycloid_client_options, ticks),
      CYCLOID_FIELD(cycloid_client_options, workers),
      CYCLOID_FIELD(cycloid_client_options, scripted),
      CYCLOID_FIELD(cycloid_client_state, struct_bytes),
      CYCLOID_FIELD(cycloid_client_state, phase),
      CYCLOID_FIELD(cycloid_client_state, end),
      CYCLOID_FIELD(cycloid_client_state, refusal),
      CYCLOID_FIELD(cycloid_client_state, seat),
      CYCLOID_FIELD(cycloid_client_state, lead_ticks),
      CYCLOID_FIELD(cycloid_client_state, early_ticks),
      CYCLOID_FIELD(cycloid_client_state, tick_rate_millihertz),
      CYCLOID_FIELD(cycloid_client_state, tick),
      CYCLOID_FIELD(cycloid_client_state, predicted_tick),
      CYCLOID_FIELD(cycloid_client_state, digest),
      CYCLOID_FIELD(cycloid_client_state, frames),
      CYCLOID_FIELD(cycloid_client_state, digests_compared),
      CYCLOID_FIELD(cycloid_client_state, mismatches),
      CYCLOID_FIELD(cycloid_client_state, resyncs),
      CYCLOID_FIELD(cycloid_client_state, inputs_sent),
      CYCLOID_FIELD(cycloid_client_state, inputs_replaced),
      CYCLOID_FIELD(cycloid_client_state, rollbacks),
      CYCLOID_FIELD(cycloid_client_state, ticks_resimulated),
      CYCLOID_FIELD(cycloid_client_state, reconnects),
      CYCLOID_FIELD(cycloid_event, tick),
      CYCLOID_FIELD(cycloid_event, value),
      CYCLOID_FIELD(cycloid_event, kind),
      CYCLOID_FIELD(cycloid_event, subject),
  };
  EXPECT_EQ(fields, promised("field"));
  const auto size = [](const char* name, std::size_t bytes) {
    return "size " + std::string(name) + " " + std::to_string(bytes);
  };
  const std::set<std::string> sizes = {
      size("cycloid_input", sizeof(cycloid_input)), size("cycloid_pose", sizeof(cycloid_pose)),
      size("cycloid_client_options", sizeof(cycloid_client_options)),
      size("cycloid_client_state", sizeof(cycloid_client_state)),
      size("cycloid_event", sizeof(cycloid_event))};
  EXPECT_EQ(sizes, promised("size"));
  EXPECT_EQ(cycloid_abi_version(), std::uint32_t{CYCLOID_ABI_VERSION});
}

/// What a call made.
struct DestroySimulation {
  void operator()(cycloid_simulation* at) const { cycloid_simulation_destroy(at); }
};
using World = std::unique_ptr<cycloid_simulation, DestroySimulation>;

World make_world(const char* scene) {
  cycloid_simulation* made = nullptr;
  EXPECT_EQ(cycloid_simulation_create(scene, &made), CYCLOID_OK) << last_error();
  return World(made);
}

std::vector<cycloid_input> scripted(const cycloid_simulation* world) {
  std::vector<cycloid_input> inputs(cycloid_simulation_seats(world));
  for (std::uint32_t seat = 0; seat < inputs.size(); ++seat) {
    inputs[seat].struct_bytes = sizeof(cycloid_input);
    EXPECT_EQ(cycloid_simulation_scripted_input(world, seat, cycloid_simulation_tick(world) + 1,
                                                &inputs[seat]),
              CYCLOID_OK);
  }
  return inputs;
}

void step(cycloid_simulation* world) {
  const auto inputs = scripted(world);
  ASSERT_EQ(
      cycloid_simulation_step(world, inputs.data(), static_cast<std::uint32_t>(inputs.size())),
      CYCLOID_OK)
      << last_error();
}

TEST(CAbi, OfflineWorldMakesTheSameBitsAsTheLibraryAndComesBackByRestoreAndDecode) {
  const World world = make_world("half-pipe");
  const scenes::Scene scene = std::move(*scenes::find("half-pipe").scene);
  scenes::Simulation right = std::move(scenes::Simulation::create(scene).value());
  cycloid_saved* saved = nullptr;
  std::vector<std::uint8_t> encoded;
  std::uint32_t count = 0;
  for (int tick = 0; tick < 60; ++tick) {
    if (tick == 30) {
      ASSERT_EQ(cycloid_simulation_save(world.get(), &saved), CYCLOID_OK);
      EXPECT_EQ(cycloid_simulation_encode(world.get(), nullptr, 0, &count), CYCLOID_BUFFER);
      encoded.resize(count);
      ASSERT_EQ(cycloid_simulation_encode(world.get(), encoded.data(), count, &count), CYCLOID_OK);
    }
    std::vector<scenes::SeatInput> inputs;
    for (int seat = 0; seat < right.seats(); ++seat)
      inputs.push_back(scenes::scripted_input(scene, seat, right.tick() + 1));
    ASSERT_TRUE(right.step(inputs).ok());
    step(world.get());
    ASSERT_EQ(cycloid_simulation_digest(world.get()), right.digest());
  }
  ASSERT_EQ(cycloid_simulation_restore(world.get(), saved), CYCLOID_OK);
  EXPECT_EQ(cycloid_simulation_tick(world.get()), 30u);
  for (int tick = 30; tick < 60; ++tick) step(world.get());
  EXPECT_EQ(cycloid_simulation_digest(world.get()), right.digest());
  ASSERT_EQ(cycloid_simulation_decode(world.get(), encoded.data(), count), CYCLOID_OK);
  for (int tick = 30; tick < 60; ++tick) step(world.get());
  EXPECT_EQ(cycloid_simulation_digest(world.get()), right.digest());

  const World other = make_world("stack-10");
  EXPECT_EQ(cycloid_simulation_restore(other.get(), saved), CYCLOID_INVALID);
  EXPECT_EQ(last_error(), "saved: of another scene");
  EXPECT_EQ(cycloid_simulation_decode(other.get(), encoded.data(), count / 2), CYCLOID_STEP);
  cycloid_saved_destroy(saved);
}

TEST(CAbi, NothingIsWrittenWhereTheMemoryIsTooSmall) {
  const World world = make_world("stack-10");
  std::uint32_t count = 0;
  EXPECT_EQ(cycloid_simulation_read_poses(world.get(), nullptr, 0, &count), CYCLOID_BUFFER);
  ASSERT_GT(count, 5u);
  std::vector<cycloid_pose> poses(count);
  poses[0].index = 12345;
  EXPECT_EQ(cycloid_simulation_read_poses(world.get(), poses.data(), count - 1, &count),
            CYCLOID_BUFFER);
  EXPECT_EQ(poses[0].index, 12345u);
  EXPECT_EQ(cycloid_simulation_read_poses(world.get(), poses.data(), count, &count), CYCLOID_OK);
  EXPECT_NE(poses[0].index, 12345u);
  std::array<char, 8> text{};
  EXPECT_EQ(cycloid_simulation_create("no-such-scene", nullptr), CYCLOID_INVALID);
  EXPECT_EQ(cycloid_last_error(text.data(), 4), std::strlen("out: null") + 1);
  EXPECT_STREQ(text.data(), "out");
}

TEST(CAbi, WrongArgumentsAreNamed) {
  cycloid_simulation* made = nullptr;
  EXPECT_EQ(cycloid_simulation_create("no-such-scene", &made), CYCLOID_SCENE);
  EXPECT_EQ(made, nullptr);
  EXPECT_NE(last_error().find("no-such-scene"), std::string::npos) << last_error();
  EXPECT_EQ(cycloid_simulation_create("/", &made), CYCLOID_SCENE);
  EXPECT_EQ(last_error(), "/: is a directory, or cannot be read");
  EXPECT_EQ(cycloid_simulation_create(nullptr, &made), CYCLOID_INVALID);
  const World world = make_world("half-pipe");
  EXPECT_EQ(cycloid_simulation_step(world.get(), nullptr, 7), CYCLOID_INVALID);
  EXPECT_EQ(last_error(), "count: 7, the scene has 2 seats");
  EXPECT_EQ(cycloid_simulation_step(nullptr, nullptr, 0), CYCLOID_INVALID);
  EXPECT_EQ(cycloid_client_poll(nullptr, 0), CYCLOID_INVALID);

  cycloid_client_options good{};
  good.struct_bytes = sizeof(good);
  ASSERT_EQ(cycloid_client_options_init(&good), CYCLOID_OK);
  EXPECT_EQ(good.seat, CYCLOID_ANY_SEAT);
  good.scene = "half-pipe";
  good.port = 1;
  struct Case {
    const char* words;
    void (*change)(cycloid_client_options&);
  };
  const Case cases[] = {
      {"scene", [](auto& options) { options.scene = nullptr; }},
      {"host", [](auto& options) { options.host = nullptr; }},
      {"mode", [](auto& options) { options.mode = 9; }},
      {"mode", [](auto& options) { options.mode = 257; }},
      {"profile", [](auto& options) { options.profile = 0; }},
      {"port", [](auto& options) { options.port = 70000; }},
      {"seat", [](auto& options) { options.seat = -3; }},
      {"predict_ticks", [](auto& options) { options.predict_ticks = 65; }},
      {"workers", [](auto& options) { options.workers = 0; }},
      {"workers", [](auto& options) { options.workers = 0xffffffffu; }},
      {"token", [](auto& options) { options.token = "not a token!"; }},
      {"resume_bytes",
       [](auto& options) { options.resume = reinterpret_cast<const std::uint8_t*>("abc"); }},
      {"struct_bytes", [](auto& options) { options.struct_bytes = 4; }},
      {"struct_bytes", [](auto& options) { options.struct_bytes = 20; }},
      {"struct_bytes", [](auto& options) { options.struct_bytes = 31; }},
      {"struct_bytes", [](auto& options) { options.struct_bytes = 84; }},
  };
  for (const Case& wrong : cases) {
    cycloid_client_options options = good;
    wrong.change(options);
    cycloid_client* client = nullptr;
    EXPECT_EQ(cycloid_client_create(&options, &client), CYCLOID_INVALID) << wrong.words;
    EXPECT_EQ(client, nullptr);
    EXPECT_TRUE(last_error().starts_with(wrong.words)) << last_error();
  }
  cycloid_client* client = nullptr;
  ASSERT_EQ(cycloid_client_create(&good, &client), CYCLOID_OK) << last_error();
  EXPECT_EQ(cycloid_client_poll(client, 0), CYCLOID_STATE);
  std::uint32_t count = 0;
  EXPECT_EQ(cycloid_client_read_resume(client, nullptr, 0, &count), CYCLOID_STATE);
  cycloid_client_destroy(client);
}

TEST(CAbi, OlderCallersStructsAreShorterAndNothingBehindThemIsTouched) {
  struct {
    cycloid_client_state state;
    unsigned char behind[8];
  } caller;
  std::memset(&caller, 0x5a, sizeof caller);
  caller.state.struct_bytes = offsetof(cycloid_client_state, frames);
  cycloid_client_options options{};
  options.struct_bytes = sizeof(options);
  ASSERT_EQ(cycloid_client_options_init(&options), CYCLOID_OK);
  options.scene = "half-pipe";
  options.port = 1;
  options.struct_bytes = offsetof(cycloid_client_options, workers);
  options.workers = 9999;  // Of a field that this caller does not know.
  cycloid_client* client = nullptr;
  ASSERT_EQ(cycloid_client_create(&options, &client), CYCLOID_OK) << last_error();
  ASSERT_EQ(cycloid_client_read_state(client, &caller.state), CYCLOID_OK);
  EXPECT_EQ(caller.state.struct_bytes, offsetof(cycloid_client_state, frames));
  EXPECT_EQ(caller.state.seat, CYCLOID_SPECTATOR);
  EXPECT_EQ(caller.state.frames, 0x5a5a5a5a5a5a5a5au);
  EXPECT_EQ(caller.behind[0], 0x5a);
  cycloid_client_destroy(client);
}

TEST(CAbi, NobodyThereIsAnEndWithAReason) {
  cycloid_client_options options{};
  options.struct_bytes = sizeof(options);
  ASSERT_EQ(cycloid_client_options_init(&options), CYCLOID_OK);
  options.scene = "half-pipe";
  options.port = 1;
  cycloid_client* client = nullptr;
  ASSERT_EQ(cycloid_client_create(&options, &client), CYCLOID_OK);
  ASSERT_EQ(cycloid_client_connect(client), CYCLOID_OK);
  EXPECT_EQ(cycloid_client_connect(client), CYCLOID_STATE);
  cycloid_client_state state{};
  state.struct_bytes = sizeof(state);
  for (int i = 0; i < 200 && state.phase != CYCLOID_PHASE_OVER; ++i) {
    ASSERT_EQ(cycloid_client_poll(client, 50), CYCLOID_OK);
    ASSERT_EQ(cycloid_client_read_state(client, &state), CYCLOID_OK);
  }
  EXPECT_EQ(state.end, std::uint32_t{CYCLOID_END_DISCONNECTED});
  std::array<char, 256> reason{};
  EXPECT_GT(cycloid_client_reason(client, reason.data(), reason.size()), 10u);
  EXPECT_NE(std::string(reason.data()).find("cannot connect"), std::string::npos) << reason.data();
  cycloid_client_destroy(client);
}

/// "tick 60 digest 0123... ..." of the example.
std::map<std::string, std::string> words_of(const std::string& text) {
  std::map<std::string, std::string> words;
  std::istringstream stream(text);
  for (std::string name, value; stream >> name >> value && name != "end";) words[name] = value;
  return words;
}

class CExample : public testing::TestWithParam<int> {};

TEST_P(CExample, PlaysAMatchAndEndsWithTheServersDigest) {
  server::ServeOptions serving;
  serving.scene = std::move(*scenes::find("half-pipe").scene);
  serving.ticks = 150;
  serving.limits.digest_ticks = 10;
  Served served(std::move(serving));
  const std::string command = "'" + places::c_example() + "' 127.0.0.1 " +
                              std::to_string(served.port()) + " half-pipe " +
                              std::to_string(GetParam());
  const Output played = run_shell(command);
  const server::ServeReport report = served.report();
  ASSERT_EQ(played.exit, 0) << played.text;
  auto words = words_of(played.text);
  char digest[17];
  snprintf(digest, sizeof digest, "%016llx", static_cast<unsigned long long>(report.final_digest));
  EXPECT_EQ(words["tick"], "150") << played.text;
  EXPECT_EQ(words["digest"], digest);
  EXPECT_EQ(words["seat"], "0");
  EXPECT_EQ(words["mismatches"], "0");
  EXPECT_NE(words["bodies"], "0");
  EXPECT_EQ(report.clients, 1u);
  EXPECT_EQ(report.desyncs, 0u);
}

INSTANTIATE_TEST_SUITE_P(Predicting, CExample, testing::Values(0, 8));

}  // namespace
}  // namespace cycloid::client
