#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace cycloid::fuzz {

using Input = std::span<const std::byte>;
using Seed = std::vector<std::byte>;

/// One door through which bytes come from outside. `run` aborts where a promise is broken: what is
/// refused changes nothing, and what is taken can be stepped and encoded. The first byte of an
/// input chooses between raw bytes and edits of a good encoding, which get behind the first checks.
struct FuzzTarget {
  const char* name;
  void (*run)(Input input);
  std::vector<Seed> (*seeds)();
};

const std::vector<FuzzTarget>& targets();

/// The target of that name, or null.
const FuzzTarget* find_target(const std::string& name);

void run_log(Input input);
std::vector<Seed> log_seeds();
void run_planar_snapshot(Input input);
std::vector<Seed> planar_snapshot_seeds();
void run_spatial_snapshot(Input input);
std::vector<Seed> spatial_snapshot_seeds();
void run_scene_json(Input input);
std::vector<Seed> scene_json_seeds();
void run_scene_binary(Input input);
std::vector<Seed> scene_binary_seeds();
void run_messages(Input input);
std::vector<Seed> message_seeds();
void run_token(Input input);
std::vector<Seed> token_seeds();
void run_room(Input input);
std::vector<Seed> room_seeds();
void run_gate(Input input);
std::vector<Seed> gate_seeds();
void run_state_delta(Input input);
std::vector<Seed> state_delta_seeds();
void run_golden(Input input);
std::vector<Seed> golden_seeds();
void run_config(Input input);
std::vector<Seed> config_seeds();

/// Ends the process with a sentence: the way in which a fuzzer learns of a failure.
[[noreturn]] void fail(const std::string& why);

/// Raw: the rest of the input is the encoding. Else it is a list of edits of 8 bytes each: where (3
/// bytes), how (1), what (4), which are applied to `good`.
enum InputMode : unsigned { kRawMode = 0, kEditMode = 1 };
unsigned mode_of(Input& input);
Seed edited(Seed good, Input edits);

/// A seed in either mode.
Seed with_mode(unsigned mode, std::span<const std::byte> bytes);

}  // namespace cycloid::fuzz
