#pragma once

#include "solver/constraints/contact.hpp"

namespace cycloid::solver {

/// Two balls roll over one another: the normal, the point and the separation follow their centres.
/// With the normal of the tick's start a glancing blow would act beside both centres and set them
/// spinning. Other shapes keep their normal during a tick.
template <int D, int W>
void follow_round(ContactBlock<D, W>& block, const Motion<D>* motions) {
  using L = Lanes<W>;
  const ContactExtra<D, W>& extra = *block.extra;
  const MotionLanes<D, W> a = gather<D, W>(motions, block.body_a);
  const MotionLanes<D, W> b = gather<D, W>(motions, block.body_b);
  const Vec<D, L> slide = b.delta_position - a.delta_position;
  const Vec<D, L> between = block.between + slide;
  const L distance = sqrt(dot(between, between));
  const L far = select(distance > L(1.0e-6f), extra.is_round, L(0.0f));
  const auto follows = far > L(0.0f);
  const L inverse = L(1.0f) / select(follows, distance, L(1.0f));
  for (int i = 0; i < D; ++i)
    block.normal[i] = select(follows, inverse * between[i], block.normal[i]);
  set_tangents(block);
  auto& point = block.points[0];
  const L separation = distance - (extra.radius_a + extra.radius_b);
  const L half = L(0.5f) * separation;
  const Vec<D, L> r_a = (extra.radius_a + half) * block.normal - block.share_b * slide;
  for (int i = 0; i < D; ++i) point.r_a[i] = select(follows, r_a[i], point.r_a[i]);
  // separation_of adds what the bodies have moved along the normal since the tick began.
  point.separation = select(follows, separation - dot(slide, block.normal), point.separation);
}

}  // namespace cycloid::solver
