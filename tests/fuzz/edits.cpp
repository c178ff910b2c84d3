#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "solver/bytes.hpp"
#include "tests/fuzz/targets.hpp"

namespace cycloid::fuzz {

void fail(const std::string& why) {
  std::fprintf(stderr, "a promise is broken: %s\n", why.c_str());
  std::abort();
}

unsigned mode_of(Input& input) {
  if (input.empty()) return kRawMode;
  const auto mode = static_cast<unsigned>(input[0]);
  input = input.subspan(1);
  return mode;
}

Seed with_mode(unsigned mode, std::span<const std::byte> bytes) {
  Seed seed(1 + bytes.size(), static_cast<std::byte>(mode));
  std::copy(bytes.begin(), bytes.end(), seed.begin() + 1);
  return seed;
}

/// Words lie at multiples of four in what the solver encodes.
static void edit(std::size_t where, unsigned how, std::uint32_t what, Seed& bytes) {
  constexpr std::size_t kGrowthMax = 1u << 16;
  if (bytes.size() < 4) return;
  const std::size_t word = where % (bytes.size() / 4) * 4;
  const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(word);
  const std::size_t count = std::min<std::size_t>(what % 256, bytes.size() - word);
  switch (how % 6) {
    case 0:
      solver::store_little(what, bytes.data() + word);
      break;
    case 1:
      bytes[where % bytes.size()] ^= static_cast<std::byte>(1u << (what % 8));
      break;
    case 2:
      solver::store_little(solver::load_little<std::uint32_t>(bytes.data() + word) + what,
                           bytes.data() + word);
      break;
    case 3:
      bytes.erase(at, at + static_cast<std::ptrdiff_t>(count));
      break;
    case 4: {
      const Seed copy(at, at + static_cast<std::ptrdiff_t>(count));
      if (bytes.size() < kGrowthMax) bytes.insert(at, copy.begin(), copy.end());
      break;
    }
    default: {
      const std::size_t from = what % (bytes.size() / 4) * 4;
      solver::store_little(solver::load_little<std::uint32_t>(bytes.data() + from),
                           bytes.data() + word);
    }
  }
}

Seed edited(Seed good, Input edits) {
  constexpr std::size_t kEditBytes = 8;
  for (; edits.size() >= kEditBytes; edits = edits.subspan(kEditBytes)) {
    const auto head = solver::load_little<std::uint32_t>(edits.data());
    const auto what = solver::load_little<std::uint32_t>(edits.data() + 4);
    edit(head & 0xffffffu, head >> 24, what, good);
  }
  return good;
}

const std::vector<FuzzTarget>& targets() {
  static const std::vector<FuzzTarget> kTargets = {
      {"log", run_log, log_seeds},
      {"snapshot-2d", run_planar_snapshot, planar_snapshot_seeds},
      {"snapshot-3d", run_spatial_snapshot, spatial_snapshot_seeds},
      {"scene-json", run_scene_json, scene_json_seeds},
      {"scene-binary", run_scene_binary, scene_binary_seeds},
      {"messages", run_messages, message_seeds},
#ifdef CYCLOID_ADMISSION
      {"token", run_token, token_seeds},
      {"gate", run_gate, gate_seeds},
#endif
#ifdef CYCLOID_NETWORK
      {"room", run_room, room_seeds},
      {"config", run_config, config_seeds},
#endif
      {"state-delta", run_state_delta, state_delta_seeds},
      {"golden", run_golden, golden_seeds},
  };
  return kTargets;
}

const FuzzTarget* find_target(const std::string& name) {
  for (const FuzzTarget& target : targets())
    if (name == target.name) return &target;
  return nullptr;
}

}  // namespace cycloid::fuzz
