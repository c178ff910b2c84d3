#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

#ifdef CYCLOID_NETWORK
namespace cycloid::cli {
namespace {

using testing::HasSubstr;

TEST(SyncTestCommand, SaysThatASceneIsGoodWithWhatItDid) {
  const Ran text = run_program({"synctest", "half-pipe", "--ticks", "20", "--distance", "8"});
  EXPECT_EQ(text.exit, 0) << text.err;
  // Ticks 1 to 7 can go back no further than to the start.
  EXPECT_EQ(text.out, "half-pipe good, 20 ticks, 152 steps\n");
  const Ran ran = run_program({"synctest", "half-pipe", "--ticks", "20", "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  const nlohmann::json object = ran.json();
  EXPECT_EQ(object["exit"], 0);
  ASSERT_EQ(object["scenes"].size(), 1u);
  EXPECT_EQ(object["scenes"][0]["good"], true);
  EXPECT_EQ(object["scenes"][0]["ticks"], 20);
  EXPECT_TRUE(object["scenes"][0]["failure"].is_null());
}

TEST(SyncTestCommand, TestsTheWholeCatalogue) {
  const Ran ran = run_program({"synctest", "--catalogue", "--ticks", "2", "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  EXPECT_GT(ran.json()["scenes"].size(), 30u);
}

TEST(SyncTestCommand, RefusesWhatItCannotTest) {
  EXPECT_EQ(run_program({"synctest"}).exit, 2);
  EXPECT_EQ(run_program({"synctest", "half-pipe", "--catalogue"}).exit, 2);
  const Ran far = run_program({"synctest", "half-pipe", "--distance", "9"});
  EXPECT_EQ(far.exit, 2);
  EXPECT_THAT(far.err, HasSubstr("--distance"));
  EXPECT_EQ(run_program({"synctest", "no-such-scene"}).exit, 2);
}

}  // namespace
}  // namespace cycloid::cli
#endif
