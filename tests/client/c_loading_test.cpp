#include <algorithm>
#include <array>
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "client/c/cycloid.h"
#include "tests/client/reconnect_fixture.hpp"
#include "tests/client/served.hpp"

namespace cycloid::client {
namespace {

struct LoadingCase {
  const char* name;
  std::uint32_t mode;
  std::uint32_t predict_ticks;
};

/// What a game draws and hears of at one time.
struct Picture {
  std::uint64_t tick = 0;
  std::vector<float> poses;    ///< Each body's index, position and rotation.
  std::vector<float> between;  ///< The same a tick and a half before.
  std::size_t bodies_told = 0;
};

std::vector<float> numbers_of(const std::vector<cycloid_pose>& poses) {
  std::vector<float> numbers;
  for (const cycloid_pose& pose : poses) {
    numbers.push_back(static_cast<float>(pose.index));
    numbers.insert(numbers.end(), pose.position, pose.position + 3);
    numbers.insert(numbers.end(), pose.rotation, pose.rotation + 4);
  }
  return numbers;
}

/// A client of the C interface whose states come in parts.
class LoadingInC : public Reconnect, public testing::WithParamInterface<LoadingCase> {
 protected:
  LoadingInC() {
    cycloid_client_options options{};
    options.struct_bytes = sizeof(options);
    EXPECT_EQ(cycloid_client_options_init(&options), CYCLOID_OK);
    options.scene = "half-pipe";
    options.port = acceptor_.local_endpoint().port();
    options.mode = GetParam().mode;
    options.predict_ticks = GetParam().predict_ticks;
    options.reconnect_deadline_ms = 10000;
    options.scripted = 1;
    cycloid_client* made = nullptr;
    EXPECT_EQ(cycloid_client_create(&options, &made), CYCLOID_OK);
    client_.reset(made);
    EXPECT_EQ(cycloid_client_connect(made), CYCLOID_OK);
  }

  cycloid_client_state state() {
    cycloid_client_state state{};
    state.struct_bytes = sizeof(state);
    EXPECT_EQ(cycloid_client_read_state(client_.get(), &state), CYCLOID_OK);
    return state;
  }
  /// Polls until the client is in the phase, and says whether it came to that.
  bool comes_to(std::uint32_t phase) {
    const auto deadline = std::chrono::steady_clock::now() + kDeadline;
    while (state().phase != phase && std::chrono::steady_clock::now() < deadline)
      EXPECT_EQ(cycloid_client_poll(client_.get(), 20), CYCLOID_OK);
    return state().phase == phase;
  }
  Picture picture() {
    Picture picture;
    picture.tick = state().predicted_tick;
    std::vector<cycloid_pose> poses(1000);
    std::uint32_t count = 0;
    EXPECT_EQ(cycloid_client_read_poses(client_.get(), poses.data(), 1000, &count), CYCLOID_OK);
    picture.poses = numbers_of({poses.begin(), poses.begin() + count});
    const double time = static_cast<double>(picture.tick) - 1.5;
    EXPECT_EQ(cycloid_client_read_poses_at(client_.get(), time, poses.data(), 1000, &count),
              CYCLOID_OK);
    picture.between = numbers_of({poses.begin(), poses.begin() + count});
    std::vector<cycloid_event> events(4096);
    EXPECT_EQ(cycloid_client_read_events(client_.get(), events.data(), 4096, &count), CYCLOID_OK);
    picture.bodies_told = static_cast<std::size_t>(
        std::count_if(events.begin(), events.begin() + count, [](const cycloid_event& event) {
          return event.kind == CYCLOID_EVENT_BODY_CREATED ||
                 event.kind == CYCLOID_EVENT_BODY_DESTROYED;
        }));
    return picture;
  }

  struct Destroy {
    void operator()(cycloid_client* client) const { cycloid_client_destroy(client); }
  };
  std::unique_ptr<cycloid_client, Destroy> client_;
};

/// Goal: a state that is not there yet is not shown, and a break leaves the picture as it is.
/// Method: two connections whose last part waits until the client was looked at.
TEST_P(LoadingInC, ShowsNothingBeforeTheFirstStateAndThenTheLastOneUntilTheNext) {
  const std::size_t bodies = authority_.simulation().poses().size();
  std::array<std::promise<void>, 2> looked_at, shown;
  auto server = std::async(std::launch::async, [&] {
    for (std::size_t i = 0; i < looked_at.size(); ++i) {
      Peer peer(acceptor_.accept());
      peer.hear_hello();
      for (int tick = 0; tick < 40; ++tick) authority_.frame();
      welcome_in_parts(peer, [&] { looked_at[i].get_future().wait_for(kDeadline); });
      for (int tick = 0; tick < 5; ++tick) peer.tell(authority_.frame());
      shown[i].get_future().wait_for(kDeadline);
      peer.hang_up();
    }
  });
  ASSERT_TRUE(comes_to(CYCLOID_PHASE_LOADING));
  const Picture nothing = picture();
  EXPECT_EQ(nothing.tick, 0u);
  EXPECT_TRUE(nothing.poses.empty());
  EXPECT_TRUE(nothing.between.empty());
  EXPECT_EQ(nothing.bodies_told, 0u);
  looked_at[0].set_value();
  ASSERT_TRUE(comes_to(CYCLOID_PHASE_RUNNING));
  EXPECT_EQ(picture().bodies_told, bodies);
  shown[0].set_value();

  ASSERT_TRUE(comes_to(CYCLOID_PHASE_CONNECTING));
  const Picture before = picture();
  EXPECT_GE(before.tick, 40u);
  ASSERT_TRUE(comes_to(CYCLOID_PHASE_LOADING));
  const Picture loading = picture();
  EXPECT_EQ(loading.tick, before.tick);
  EXPECT_EQ(loading.poses, before.poses);
  EXPECT_EQ(loading.between, before.between);
  EXPECT_EQ(loading.bodies_told, 0u);
  looked_at[1].set_value();
  ASSERT_TRUE(comes_to(CYCLOID_PHASE_RUNNING));
  const Picture after = picture();
  EXPECT_GE(after.tick, 85u);
  EXPECT_NE(after.poses, before.poses);
  EXPECT_EQ(after.bodies_told, 0u) << "the same bodies all along";
  shown[1].set_value();
  client_.reset();
}

INSTANTIATE_TEST_SUITE_P(Modes, LoadingInC,
                         testing::Values(LoadingCase{"lockstep", CYCLOID_MODE_LOCKSTEP, 0},
                                         LoadingCase{"predicting", CYCLOID_MODE_LOCKSTEP, 8},
                                         LoadingCase{"snapshot", CYCLOID_MODE_SNAPSHOT, 0}),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace cycloid::client
