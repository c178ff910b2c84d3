#pragma once

#include <string>
#include <vector>

#include "bench/peers/accuracy.hpp"
#include "bench/worlds/bench_worlds.hpp"

namespace cycloid::bench {

struct MeasureOptions {
  int runs = 3;                ///< Of every scene; at most its `runs_max`.
  int worlds = 0;              ///< In rotation; 0: as many as the scene says.
  int lanes = 0;               ///< Of ours; 0: each step takes the width that suits it.
  int workers = 1;             ///< Above 1, ours is measured with so many threads, too.
  std::uint32_t substeps = 0;  ///< Of ours; 0: those of the scene.
  bool sleep = false;          ///< Bodies at rest may sleep, in every engine.
  bool peers = true;
};

/// One engine on one scene.
struct EngineResult {
  std::string engine;
  std::string why_not;   ///< "" where it was measured.
  double step_us = 0.0;  ///< Per step of one world: the median over the runs of each chunk, summed.
  double least_us = 0.0;  ///< The same of the fastest run of each chunk.
  /// Ours over this engine's: the median over all chunks and runs. 1 for ours.
  double ratio = 1.0;
  double bytes = 0.0;          ///< Of memory that one world holds at the end.
  peers::Accuracy accuracy;    ///< Worst at the end of any chunk, of the first world.
  std::uint32_t contacts = 0;  ///< At the end, of the first world.
  std::uint64_t digest = 0;    ///< At the end, of the first world; 0: the engine has none.
};

struct SceneResult {
  worlds::BenchWorld world;
  std::uint32_t bodies = 0;
  std::uint32_t joints = 0;
  int runs = 0;
  std::vector<EngineResult> engines;  ///< Ours is the first.
};

/// Steps every engine through the same scene in one process, chunk by chunk in turn, so that all
/// meet the same noise. Time is processor time where one thread works, else of the wall.
/// Exits with a message where our own world refuses the scene or a step.
SceneResult measure_scene(const worlds::BenchWorld& world, const MeasureOptions& options);

}  // namespace cycloid::bench
