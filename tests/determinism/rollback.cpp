#include "tests/determinism/rollback.hpp"

#include <map>
#include <random>

namespace cycloid::history {

std::vector<std::uint64_t> digests_of(const Scene& scene, const Match& match) {
  Simulation simulation = begin(scene);
  std::vector<std::uint64_t> digests = {simulation.digest()};
  for (const std::vector<SeatInput>& inputs : match) {
    EXPECT_TRUE(simulation.step(inputs).ok()) << "tick " << simulation.tick() + 1;
    digests.push_back(simulation.digest());
  }
  return digests;
}

RollbackClient::RollbackClient(const Scene& scene)
    : simulation_(begin(scene)), saved_(kRollbackTicks + 1), confirmed_({simulation_.digest()}) {
  simulation_.save(saved_[0]);
}

RollbackClient::Told& RollbackClient::told(std::uint64_t tick) {
  while (told_.size() <= tick)
    told_.emplace_back().heard.resize(static_cast<std::size_t>(simulation_.seats()));
  return told_[tick];
}

void RollbackClient::hear(std::uint64_t tick, std::size_t seat, const SeatInput& input) {
  told(tick).heard[seat] = input;
}

std::vector<SeatInput> RollbackClient::guess(std::uint64_t tick) {
  std::vector<SeatInput> inputs(static_cast<std::size_t>(simulation_.seats()));
  for (std::size_t seat = 0; seat < inputs.size(); ++seat)
    for (std::uint64_t at = tick; at > 0; --at)
      if (told(at).heard[seat]) {
        inputs[seat] = *told(at).heard[seat];
        break;
      }
  return inputs;
}

void RollbackClient::make_tick() {
  const std::uint64_t tick = simulation_.tick() + 1;
  const std::vector<SeatInput> inputs = guess(tick);
  ASSERT_TRUE(simulation_.step(inputs).ok()) << "tick " << tick;
  Told& now = told(tick);
  const bool again = !now.used.empty();
  const std::uint64_t digest = simulation_.digest();
  if (again && now.digest != digest) ++wrong_digests;
  now.used = inputs;
  now.digest = digest;
  simulation_.save(saved_[tick % saved_.size()]);
}

void RollbackClient::mend() {
  const std::uint64_t now = simulation_.tick();
  std::uint64_t wrong = confirmed_.size();
  while (wrong <= now && guess(wrong) == told(wrong).used) ++wrong;
  if (wrong <= now) {
    ASSERT_LE(now - wrong + 1, kRollbackTicks) << "nothing is kept of the tick before " << wrong;
    ++rollbacks;
    longest_rollback = std::max(longest_rollback, now - wrong + 1);
    simulation_.restore(saved_[(wrong - 1) % saved_.size()]);
    ASSERT_EQ(simulation_.tick(), wrong - 1);
    while (simulation_.tick() < now) make_tick();
  }
  confirm();
}

void RollbackClient::confirm() {
  const auto came = [](const std::optional<SeatInput>& input) { return input.has_value(); };
  for (std::uint64_t tick = confirmed_.size(); tick <= simulation_.tick(); ++tick) {
    const Told& all = told(tick);
    if (!std::all_of(all.heard.begin(), all.heard.end(), came)) return;
    confirmed_.push_back(all.digest);
  }
}

void RollbackClient::advance() {
  mend();
  make_tick();
  confirm();
}

namespace {

struct Letter {
  std::uint64_t tick;
  std::size_t seat;
};

/// Which inputs come just before which tick is made. A change of mind is the news that matters, so
/// many of those are as late as can be.
std::multimap<std::uint64_t, Letter> post(const Match& match, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::multimap<std::uint64_t, Letter> letters;
  for (std::uint64_t tick = 1; tick <= match.size(); ++tick)
    for (std::size_t seat = 0; seat < match[tick - 1].size(); ++seat) {
      const bool news = tick > 1 && match[tick - 1][seat] != match[tick - 2][seat];
      const bool latest = news && random() % 2 == 0;
      const std::uint64_t late = latest ? kRollbackTicks : random() % (kRollbackTicks + 1);
      letters.insert({tick + late, {tick, seat}});
    }
  return letters;
}

}  // namespace

void expect_equal_in_rollback(const Match& match, const std::vector<std::uint64_t>& right,
                              std::uint32_t seed, RollbackClient& client) {
  const auto letters = post(match, seed);
  std::size_t compared = 0;
  const auto compare = [&] {
    for (; compared < client.confirmed().size(); ++compared)
      ASSERT_EQ(client.confirmed()[compared], right[compared])
          << "tick " << compared << ", confirmed in tick " << client.tick();
  };
  for (std::uint64_t tick = 1; tick <= match.size(); ++tick) {
    const auto [first, last] = letters.equal_range(tick);
    for (auto at = first; at != last; ++at)
      client.hear(at->second.tick, at->second.seat, match[at->second.tick - 1][at->second.seat]);
    client.advance();
    compare();
    if (testing::Test::HasFatalFailure()) return;
  }
  for (auto at = letters.upper_bound(match.size()); at != letters.end(); ++at)
    client.hear(at->second.tick, at->second.seat, match[at->second.tick - 1][at->second.seat]);
  client.mend();
  compare();
  EXPECT_EQ(compared, match.size() + 1);
}

}  // namespace cycloid::history
