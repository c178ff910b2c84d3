#pragma once

#include <string>
#include <vector>

namespace cycloid::bench {

/// How far everything overlaps in the heaps of one engine, one number for each start. Of one heap
/// the deepest overlap is chance; over many, starts that engines have in common tell them apart.
struct HeapOverlaps {
  std::string engine;
  /// Root of the mean square [mm] over all pairs that overlap, by the ruler of
  /// bench/peers/accuracy.hpp, in every third tick: half a second to three seconds after the start,
  /// in which a heap comes down.
  std::vector<double> landing_mm;
  std::vector<double> resting_mm;   ///< The same of the two seconds behind it.
  std::vector<double> fastest_m_s;  ///< The greatest speed of any body in all that time.
};

/// Drops bodies in every engine that holds scenes of that dimension: ours by default and by Soft
/// Step, and the peers. In the plane heaps of 40 to 400 bodies, that many of sizes as evenly apart
/// as can be; in space the 150 balls of `ball-pit-3d`. From the second start of a scene on bodies
/// begin with speeds of their own of up to 1 mm/s (trials/perturb.hpp).
/// Exits with a message where an engine loses a body.
/// @param mass_ratio  Each body is as heavy as the scene says, or, as a seed decides, so many times
///                    as heavy.
template <int D>
std::vector<HeapOverlaps> measure_heaps(int starts, float mass_ratio = 1.0f);

/// A row for each engine: the means over all starts, and of the differences from the first engine
/// start by start, with their standard errors; and the median and the greatest of the speeds.
/// @param what  "heaps of 40 to 400 bodies".
/// @pre two starts or more.
std::string heaps_markdown(const std::vector<HeapOverlaps>& engines, const std::string& what);

}  // namespace cycloid::bench
