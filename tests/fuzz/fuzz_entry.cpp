#include <cstdint>

#include "tests/fuzz/targets.hpp"

/// libFuzzer's door to one target: the build names it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const cycloid::fuzz::FuzzTarget* const kTarget =
      cycloid::fuzz::find_target(CYCLOID_FUZZ_TARGET);
  if (kTarget == nullptr) cycloid::fuzz::fail("there is no target " CYCLOID_FUZZ_TARGET);
  kTarget->run({reinterpret_cast<const std::byte*>(data), size});
  return 0;
}
