#pragma once

#include <cstdint>
#include <string>

#include "bench/accuracy/metrics.hpp"
#include "bench/accuracy/settings.hpp"
#include "bench/trials/course.hpp"
#include "solver/world.hpp"

namespace cycloid::accuracy {

/// What is measured: a scene with its script, and for how long.
struct Subject {
  scenes::Scene scene;
  std::uint32_t ticks = 300;
  trials::Act<2> act = nullptr;  ///< Something that happens besides what the scene says.
};

/// Whether something acts on its bodies of which the state of its world does not tell: the script
/// of a seat, a character, or `act`.
bool is_acted_on(const Subject& subject);

/// How thoroughly.
struct MeasureOptions {
  std::uint32_t every = 5;  ///< Ticks between two looks at the poses.
  std::uint32_t direct_rows_max =
      80;                    ///< Of the problem that the direct reference solves; 0: none.
  bool consistency = false;  ///< Runs 16 times the ticks of a second once more.
  bool impulses = true;      ///< False: nobody knows them, as of other engines.
  bool sleep = false;        ///< False: no body sleeps, so that rest shows its cost and its jitter.
};

/// What came of one setting.
struct Measured {
  Setting setting;
  bool ended = true;  ///< False: the world faulted or was no longer finite; the metrics end there.
  Metrics metrics;
  Price price;
  std::uint64_t digest = 0;  ///< Of the last state.
};

/// Rows that a tick has solved; those of the tree solver in each of its sweeps too.
/// @param tuning  what the world ran with.
double rows_of_tick(const solver::Statistics& statistics, const solver::Tuning& tuning);

/// Runs the subject once and measures every metric; nothing of it is timed. The same bits every
/// time and on every machine, but for the metrics' last digits where libm is another.
/// @pre the scene has no mistake; setting.method is one.
Measured measure(const Subject& subject, const Setting& setting, const MeasureOptions& options);

/// The distance by which shapes and joints are off in the steady time, m: the larger of the 95th
/// percentiles of penetration and gap, in a scene without rigid joints of penetration alone;
/// infinite where the run has not ended, since nobody has measured its steady time. It does not see
/// that something has fallen: see Metrics::moved_m and trials::judge.
double position_error_m(const Measured& measured);

/// Processor time of a tick, ns: one run from the start, of which only the steps are timed.
/// @pre as for `measure`.
double time_ticks(const Subject& subject, const Setting& setting, const MeasureOptions& options);

}  // namespace cycloid::accuracy
