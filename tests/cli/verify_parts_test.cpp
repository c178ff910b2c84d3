#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "scenes/simulation.hpp"
#include "tests/cli/logs.hpp"
#include "tests/cli/program.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kTicks = 120;

/// A log of 120 ticks with a state after every 20th.
class VerifyInParts : public testing::Test {
 protected:
  VerifyInParts() : log_(folder_.file("match.cylog")) {
    const Ran ran = run_program({"run", "half-pipe", "--ticks", std::to_string(kTicks),
                                 "--keyframe-every", "20", "--log", log_});
    EXPECT_EQ(ran.exit, 0) << ran.err;
  }

  /// What verify says with one thread, which is what it says with more.
  Ran verify() const {
    Ran one = run_program({"verify", log_});
    for (const char* jobs : {"2", "3", "4", "6", "64"}) {
      const Ran more = run_program({"verify", log_, "--jobs", jobs});
      EXPECT_EQ(more.exit, one.exit) << jobs;
      EXPECT_EQ(more.out, one.out) << jobs;
    }
    return one;
  }

  Folder folder_;
  std::string log_;
};

TEST_F(VerifyInParts, AGoodLogIsGoodInAnyNumberOfThem) {
  const Ran ran = verify();
  EXPECT_EQ(ran.exit, 0);
  EXPECT_THAT(ran.out, HasSubstr("120 ticks"));
}

TEST_F(VerifyInParts, TheFirstTickThatDiffersIsNamedWhicheverPartMeetsOne) {
  rewrite_records(log_, {.tick = [](protocol::LogTick& tick) {
                    if (tick.frame.tick == 37 || tick.frame.tick == 93) tick.digest ^= 1;
                  }});
  const Ran ran = verify();
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, HasSubstr("diverged at tick 37: recorded "));
}

/// A state between two parts from which all that follows is right: nothing but that the part before
/// it leads elsewhere tells of it.
TEST_F(VerifyInParts, AStateThatWasNotReachedIsFoundThoughAllThatFollowsFitsIt) {
  const scenes::Scene scene = *scenes::find("half-pipe").scene;
  auto forged = scenes::Simulation::create(scene);
  ASSERT_TRUE(forged.ok());
  scenes::Simulation& world = forged.value();
  const auto step = [&](protocol::LogTick& tick) {
    std::vector<scenes::SeatInput> inputs;
    for (const protocol::SeatFrame& seat : tick.frame.seats) inputs.push_back(seat.input);
    const bool honest = tick.frame.tick < 60;
    if (honest) inputs.assign(inputs.size(), {.axes = {32767}});  // Nobody steered like this.
    ASSERT_TRUE(world.step(inputs).ok());
    if (!honest) tick.digest = world.digest();
  };
  rewrite_records(log_, {step, [&](protocol::LogKeyframe& keyframe) {
                           if (keyframe.tick < 60) return;
                           keyframe.state.clear();
                           world.encode(keyframe.state);
                           keyframe.digest = world.digest();
                         }});
  const Ran ran = verify();
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, HasSubstr("diverged at tick 60: recorded "));
}

TEST_F(VerifyInParts, AStateOfNoSceneIsSaidToBeAnotherThanTheOneReached) {
  rewrite_records(log_, {.keyframe = [](protocol::LogKeyframe& keyframe) {
                    if (keyframe.tick == 80) keyframe.state.assign(9, std::byte{0});
                  }});
  const Ran ran = verify();
  EXPECT_EQ(ran.exit, 1);
  EXPECT_THAT(ran.out, HasSubstr("diverged at tick 80: the keyframe in the log is not the state"));
}

TEST_F(VerifyInParts, SeveralLogsShareTheThreads) {
  const std::string other = folder_.file("other.cylog");
  std::filesystem::copy_file(log_, other);
  rewrite_records(log_,
                  {.tick = [](protocol::LogTick& tick) { tick.digest ^= tick.frame.tick == 101; }});
  const Ran one = run_program({"verify", folder_.path()});
  EXPECT_THAT(one.out, HasSubstr("diverged at tick 101"));
  for (const char* jobs : {"2", "3", "5", "8"}) {
    const Ran more = run_program({"verify", folder_.path(), "--jobs", jobs});
    EXPECT_EQ(more.exit, 1) << jobs;
    EXPECT_EQ(more.out, one.out) << jobs;
  }
}

}  // namespace
}  // namespace cycloid::cli
