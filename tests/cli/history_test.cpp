#include <gtest/gtest.h>

#include <sstream>

#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"
#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

constexpr int kTicks = 8;

/// What `cycloid run` prints of a scene, by this process.
std::string digests_here(const std::string& name) {
  const scenes::Scene scene = std::move(*scenes::find(name).scene);
  scenes::Simulation simulation = std::move(scenes::Simulation::create(scene).value());
  std::ostringstream text;
  for (std::uint64_t tick = 1; tick <= kTicks; ++tick) {
    std::vector<scenes::SeatInput> inputs;
    for (int seat = 0; seat < simulation.seats(); ++seat)
      inputs.push_back(scenes::scripted_input(scene, seat, tick));
    EXPECT_TRUE(simulation.step(inputs).ok());
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx",
                  static_cast<unsigned long long>(simulation.digest()));
    text << tick << ' ' << digits << '\n';
  }
  return text.str();
}

// Each scene by a program that was started for it alone, and by this process, which runs all of
// them one after the other, there and back.
TEST(ProcessHistory, RunsBeforeInTheProcessAreInvisible) {
  std::vector<std::string> alone;
  std::vector<std::string> names;
  for (const scenes::CatalogueEntry& entry : scenes::catalogue()) {
    names.push_back(entry.name);
    const Ran ran =
        run_program({"run", entry.name, "--ticks", std::to_string(kTicks), "--digest-every", "1"});
    ASSERT_EQ(ran.exit, 0) << ran.err;
    alone.push_back(ran.out);
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    EXPECT_EQ(digests_here(names[i]), alone[i]) << names[i] << ", forward";
  for (std::size_t i = names.size(); i-- > 0;)
    EXPECT_EQ(digests_here(names[i]), alone[i]) << names[i] << ", backward";
}

}  // namespace
}  // namespace cycloid::cli
