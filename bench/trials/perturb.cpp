#include "bench/trials/perturb.hpp"

#include "scenes/generators/generators.hpp"

namespace cycloid::trials {

/// m/s. A whole number over another is rounded once, so it is the same float on every machine.
static float draw_change(scenes::Random& random) {
  constexpr std::uint64_t kChoices = 2 * kPerturbationMax_um_s + 1;
  const auto chosen = static_cast<std::int32_t>(random.next() % kChoices);
  return static_cast<float>(chosen - kPerturbationMax_um_s) / 1.0e6f;
}

void perturb(scenes::Scene& scene, const Start& start) {
  if (start.run == 0) return;
  // Scrambled first: else run 2 of seed 1 would begin as run 1 of seed 2.
  scenes::Random of_seed{start.seed};
  scenes::Random random{of_seed.next() + start.run};
  for (scenes::SceneBody& body : scene.bodies) {
    const bool responds =
        body.kind == solver::BodyKind::kDynamic || body.kind == solver::BodyKind::kParticle;
    if (!responds) continue;
    for (std::size_t i = 0; i < static_cast<std::size_t>(scene.dimension); ++i)
      body.velocity[i] += draw_change(random);
  }
}

Outcome judge_from(const scenes::Trial& trial, const solver::Tuning& method, const Start& start) {
  const Judge& by = judge_of(trial);
  scenes::Scene scene = trial.make();
  perturb(scene, start);
  return judged(by, run_scene(std::move(scene), trial.ticks, method, by.act));
}

}  // namespace cycloid::trials
