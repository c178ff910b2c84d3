#include "solver/constraints/single_lanes.hpp"
#include "solver/tracing/tracer.hpp"

namespace cycloid::solver {

template <int D, int W>
static PointWork<D> point_of(const typename ContactBlock<D, W>::Point& point, const Vec<D>& between,
                             int lane) {
  PointWork<D> work;
  work.r_a = lane_of(point.r_a, lane);
  work.r_b = work.r_a - between;
  work.separation = lane_of(point.separation, lane);
  work.normal_mass = lane_of(point.normal_mass, lane);
  work.normal_impulse = lane_of(point.normal_impulse, lane);
  for (int t = 0; t < Dim<D>::kTangents; ++t) {
    work.tangent_mass[t] = lane_of(point.tangent_mass[t], lane);
    work.tangent_impulse[t] = lane_of(point.tangent_impulse[t], lane);
  }
  return work;
}

/// What only some contacts have; elsewhere it is 0.
template <int D, int W>
static void add_extra(const ContactExtra<D, W>& extra, int lane, std::uint32_t points,
                      ContactWork<D>& work) {
  work.restitution = lane_of(extra.restitution, lane);
  work.rolling = lane_of(extra.rolling, lane);
  work.twist = lane_of(extra.twist, lane);
  work.pull = lane_of(extra.pull, lane);
  work.rolling_impulse = lane_of(extra.rolling_impulse, lane);
  for (std::uint32_t p = 0; p < points; ++p) {
    work.points[p].bounce_impulse = lane_of(extra.bounce_impulse[p], lane);
    work.points[p].position_impulse = lane_of(extra.position_impulse[p], lane);
  }
}

/// @param points  How many the contact has; other lanes of the block may have more.
template <int D, int W>
static ContactWork<D> contact_of(const ContactBlock<D, W>& block, int lane, std::uint32_t points) {
  ContactWork<D> work{};
  work.body_a = block.body_a[lane];
  work.body_b = block.body_b[lane];
  work.normal = lane_of(block.normal, lane);
  for (std::size_t t = 0; t < work.tangent.size(); ++t)
    work.tangent[t] = lane_of(tangent_of(block, static_cast<int>(t)), lane);
  work.friction = lane_of(block.friction, lane);
  const Vec<D> between = lane_of(block.between, lane);
  for (std::uint32_t p = 0; p < points; ++p)
    work.points[p] = point_of<D, W>(block.points[p], between, lane);
  if (block.extra != nullptr) add_extra(*block.extra, lane, points, work);
  return work;
}

template <int D, int W>
void read_blocks(const StepScratch<D>& scratch, std::vector<ContactWork<D>>& contacts) {
  for (const ContactBlock<D, W>& block :
       std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks) {
    for (int lane = 0; lane < kLaneCount<W>; ++lane) {
      const std::uint32_t index = block.contact[lane];
      if (index == kNone) continue;
      contacts[index] = contact_of(block, lane, scratch.contacts[index].point_count);
    }
  }
}

template <int D, int W>
struct InstantiateRead {
  decltype(&read_blocks<D, W>) read = &read_blocks<D, W>;
};
template struct AtEveryWidth<InstantiateRead>;

}  // namespace cycloid::solver
