#include "solver/collision/collide.hpp"
#include "solver/collision/few_cornered.hpp"
#include "solver/collision/hull.hpp"
#include "solver/lane_widths.hpp"

namespace cycloid::solver {

static bool is_outline(ShapeKind kind) {
  return kind == ShapeKind::kPolygon || kind == ShapeKind::kCapsule || kind == ShapeKind::kSegment;
}

/// What is done to a pair: one of each for its two shapes.
enum class InLanes : std::uint8_t { kOutline, kBall, kNever };

static InLanes way_of(const Shape<2>& shape) {
  if (shape.kind == ShapeKind::kBall) return InLanes::kBall;
  const bool has_few_corners = shape.kind == ShapeKind::kCapsule ||
                               (shape.kind == ShapeKind::kPolygon && shape.vertex_count <= 4);
  return has_few_corners ? InLanes::kOutline : InLanes::kNever;
}

/// Collides pair after pair. What a pair has of its shape a alone is made once for pairs in a row
/// that share it.
class OneByOne {
 public:
  Manifold<2> operator()(const Collider<2>& collider, const PlacedPair<2>& pair) {
    const Shape<2>& a = collider.shapes[pair.shape_a];
    const Shape<2>& b = collider.shapes[pair.shape_b];
    if (!is_outline(a.kind) || !is_outline(b.kind))
      return collide(a, pair.pose_a, b, pair.pose_b, pair.margin, collider.polyhedra);
    if (shape_ != &a) {
      hull_ = make_hull(a, pair.pose_a.rotation, Vec<2>::zero());
      shape_ = &a;
    }
    const Vec<2> a_to_b = pair.pose_b.position - pair.pose_a.position;
    return hull_against_hull(hull_, make_hull(b, pair.pose_b.rotation, a_to_b), pair.margin);
  }

 private:
  const Shape<2>* shape_ = nullptr;  ///< Whose hull it is.
  Hull hull_;
};

/// Which pairs of a call wait for lanes.
struct Waiting {
  std::uint32_t pairs[kPairGrain];
  int count = 0;
};

/// What is done to pairs in lanes: two outlines, an outline and a ball, or two balls.
struct TwoOutlines {
  template <int W, class... Arguments>
  static void collide(const Arguments&... arguments) {
    FewCornered<W>::collide(arguments...);
  }
};
struct OutlineAndBall {
  template <int W, class... Arguments>
  static void collide(const Arguments&... arguments) {
    FewCornered<W>::collide_ball(arguments...);
  }
};
struct TwoBalls {
  template <int W, class... Arguments>
  static void collide(const Arguments&... arguments) {
    FewCornered<W>::collide_balls(arguments...);
  }
};

/// As many pairs as there are lanes, or the `used` last ones and then the last one again.
template <class Of, int W>
static void collide_block(const Collider<2>& collider, const PlacedPair<2>* pairs,
                          const std::uint32_t* waiting, int used, Manifold<2>* manifolds) {
  LaneIndices<W> in_lane;
  for (int lane = 0; lane < kLaneCount<W>; ++lane)
    in_lane[lane] = waiting[lane < used ? lane : used - 1];
  Of::template collide<W>(collider.shapes, pairs, in_lane, manifolds);
}

/// The pairs that wait, W at a time. The last ones, where they would leave three quarters of the
/// lanes empty, cost less by themselves.
template <class Of, int W>
static void collide_in_lanes(const Collider<2>& collider, const PlacedPair<2>* pairs,
                             const Waiting& waiting, OneByOne& one_by_one, Manifold<2>* manifolds) {
  int begin = 0;
  while (begin < waiting.count) {
    const int left = waiting.count - begin;
    const std::uint32_t* next = waiting.pairs + begin;
    // What would leave half of the sixteen lanes empty takes as long in eight.
    if constexpr (W == kAvx512Lanes) {
      if (4 * left <= kLaneCount<kAvx2Lanes>) break;
      if (left <= kLaneCount<kAvx2Lanes>)
        return collide_block<Of, kAvx2Lanes>(collider, pairs, next, left, manifolds);
    }
    const int used = left < kLaneCount<W> ? left : kLaneCount<W>;
    if (4 * used <= kLaneCount<W>) break;
    collide_block<Of, W>(collider, pairs, next, used, manifolds);
    begin += used;
  }
  for (int i = begin; i < waiting.count; ++i)
    manifolds[waiting.pairs[i]] = one_by_one(collider, pairs[waiting.pairs[i]]);
}

template <>
void Collider<2>::operator()(const PlacedPair<2>* pairs, int count, Manifold<2>* manifolds,
                             PairMemory<2>&) const {
  OneByOne one_by_one;
  Waiting by_balls[3];  // By how many of the two are balls.
  for (int i = 0; i < count; ++i) {
    const InLanes a = way_of(shapes[pairs[i].shape_a]);
    const InLanes b = way_of(shapes[pairs[i].shape_b]);
    if (lanes == 1 || a == InLanes::kNever || b == InLanes::kNever) {
      manifolds[i] = one_by_one(*this, pairs[i]);
      continue;
    }
    Waiting& waiting = by_balls[static_cast<int>(a) + static_cast<int>(b)];
    waiting.pairs[waiting.count++] = static_cast<std::uint32_t>(i);
  }
  at_width(lanes, [&]<int W>() {
    collide_in_lanes<TwoOutlines, W>(*this, pairs, by_balls[0], one_by_one, manifolds);
    collide_in_lanes<OutlineAndBall, W>(*this, pairs, by_balls[1], one_by_one, manifolds);
    collide_in_lanes<TwoBalls, W>(*this, pairs, by_balls[2], one_by_one, manifolds);
  });
}

template <>
void Collider<3>::operator()(const PlacedPair<3>* pairs, int count, Manifold<3>* manifolds,
                             PairMemory<3>& memory) const {
  for (int i = 0; i < count; ++i) {
    const PlacedPair<3>& pair = pairs[i];
    const Shape<3>& a = shapes[pair.shape_a];
    const Shape<3>& b = shapes[pair.shape_b];
    if (is_held(a, b))
      memory.collide(pair, manifolds[i]);
    else
      manifolds[i] = collide(a, pair.pose_a, b, pair.pose_b, pair.margin, polyhedra);
  }
}

}  // namespace cycloid::solver
