#include "client/replica/sync_test.hpp"

#include <algorithm>
#include <utility>

#include "scenes/catalogue.hpp"

namespace cycloid::client {

SyncTest::SyncTest(Rewindable& world, SyncTestOptions options)
    : world_(world), options_(options), first_tick_(world.tick()), digests_(kSyncDistanceMax + 1) {
  options_.distance = std::min(options_.distance, kSyncDistanceMax);
  world_.save(place(first_tick_));
  digests_[place(first_tick_)] = world_.digest();
}

std::optional<SyncFailure> SyncTest::advance() {
  const std::uint64_t now = world_.tick();
  if (auto failure = step(now)) return failure;
  world_.save(place(now + 1));
  digests_[place(now + 1)] = world_.digest();

  const std::uint64_t wanted =
      options_.distance != 0 ? options_.distance : 1 + (now - first_tick_) % kSyncDistanceMax;
  const std::uint64_t distance = std::min(wanted, now + 1 - first_tick_);
  const std::uint64_t from = now + 1 - distance;
  world_.restore(place(from));
  ++restores_;
  while (world_.tick() < now + 1) {
    if (auto failure = step(from)) return failure;
    const std::uint64_t tick = world_.tick();
    const std::uint64_t digest = digests_[place(tick)];
    const std::uint64_t again = world_.digest();
    if (again != digest) {
      return SyncFailure{tick, from, digest, again, world_.difference(place(tick)), ""};
    }
  }
  return std::nullopt;
}

std::optional<SyncFailure> SyncTest::step(std::uint64_t from_tick) {
  ++steps_;
  const std::uint64_t tick = world_.tick() + 1;
  const std::string error = world_.step();
  if (error.empty() && world_.tick() == tick) return std::nullopt;
  SyncFailure failure;
  failure.tick = tick;
  failure.from_tick = from_tick;
  failure.error = error.empty() ? "the tick does not go up by one" : error;
  return failure;
}

RewindableScene::RewindableScene(const scenes::Scene& scene, Inputs inputs)
    : scene_(scene),
      inputs_(std::move(inputs)),
      simulation_(std::move(scenes::Simulation::create(scene).value())),
      saved_(kSyncDistanceMax + 1),
      coming_(static_cast<std::size_t>(simulation_.seats())) {
  if (inputs_) return;
  inputs_ = [this](int seat, std::uint64_t tick) {
    return scenes::scripted_input(scene_, seat, tick);
  };
}

std::string RewindableScene::step() {
  for (std::size_t seat = 0; seat < coming_.size(); ++seat) {
    coming_[seat] = inputs_(static_cast<int>(seat), tick() + 1);
  }
  const solver::Error error = simulation_.step(coming_);
  if (error.ok()) return "";
  return std::string(solver::code_name(error.code)) + " " + error.field;
}

void RewindableScene::save(std::size_t place) {
  simulation_.save(saved_[place]);
}

void RewindableScene::restore(std::size_t place) {
  simulation_.restore(saved_[place]);
}

std::string RewindableScene::difference(std::size_t place) {
  scenes::Simulation before = std::move(scenes::Simulation::create(scene_).value());
  before.restore(saved_[place]);
  for (const solver::Difference& at : before.differences(simulation_, 1)) {
    return at.object + " " + at.field + ": " + at.value_a + " and " + at.value_b;
  }
  return "";
}

}  // namespace cycloid::client
