#include "bench/peers/our_world.hpp"

#include <cstdio>
#include <cstdlib>

#include "scenes/controls.hpp"

namespace cycloid::peers {

template <int D>
class OurWorld final : public Engine<D> {
 public:
  explicit OurWorld(std::unique_ptr<scenes::Built<D>> built) : built_(std::move(built)) {}

  void step(std::span<const scenes::SeatInput> inputs) override {
    scenes::apply_controls(*built_, inputs);
    if (const solver::Error error = built_->world.step(); !error.ok()) {
      // A time of fewer ticks than asked for would look like a fast one.
      std::fprintf(stderr, "our world refused a step: %s\n", error.field);
      std::exit(1);
    }
  }

  solver::Pose<D> pose(std::uint32_t body) const override {
    const solver::Body<D>& record = built_->world.state().bodies[body];
    return {record.position, record.rotation};
  }

  Twist<D> twist(std::uint32_t body) const override {
    const solver::Body<D>& record = built_->world.state().bodies[body];
    return {record.velocity, record.spin};
  }

  std::uint32_t contacts() const override {
    std::uint32_t count = 0;
    for (const solver::Contact<D>& contact : built_->world.state().contacts)
      count += contact.touching;
    return count;
  }
  std::uint64_t digest() const override { return built_->world.digest(); }

 private:
  std::unique_ptr<scenes::Built<D>> built_;
};

/// What all our worlds that are there at the same time step in, as the rooms of a server do.
template <int D>
static std::shared_ptr<solver::StepMemory<D>> shared_step_memory() {
  static std::weak_ptr<solver::StepMemory<D>> kept;
  std::shared_ptr<solver::StepMemory<D>> memory = kept.lock();
  if (memory == nullptr) kept = memory = solver::make_step_memory<D>();
  return memory;
}

template <int D>
std::unique_ptr<Engine<D>> make_our_world(const EngineInput<D>& input, std::string& why) {
  std::vector<scenes::Mistake> mistakes;
  auto built = scenes::build<D>(input.scene, mistakes);
  if (built == nullptr) {
    why = mistakes[0].path + ": " + mistakes[0].reason;
    return nullptr;
  }
  for (const solver::Error& error : {built->world.set_lanes(input.settings.lanes),
                                     built->world.set_workers(input.settings.workers)}) {
    if (error.ok()) continue;
    why = error.field;
    return nullptr;
  }
  built->world.use_step_memory(shared_step_memory<D>());
  return std::make_unique<OurWorld<D>>(std::move(built));
}

template std::unique_ptr<Engine<2>> make_our_world(const EngineInput<2>&, std::string&);
template std::unique_ptr<Engine<3>> make_our_world(const EngineInput<3>&, std::string&);

}  // namespace cycloid::peers
