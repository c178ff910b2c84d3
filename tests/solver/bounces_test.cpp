#include <gtest/gtest.h>

#include <vector>

#include "solver/constraints/contact_kernels.hpp"
#include "solver/constraints/single_lanes.hpp"

namespace cycloid::solver {

/// A block whose lane 0 has a body, slot 0, that falls at 2 m/s towards slot 1, which has no mass.
/// It has room for two points; the gap of one that is not there is 0.
struct FallingBody {
  ContactBlock<2, 4> block{};
  ContactExtra<2, 4> extra{};
  std::vector<Motion<2>> motions = std::vector<Motion<2>>(2);

  FallingBody() {
    block.extra = &extra;
    for (int lane = 0; lane < 4; ++lane) block.body_a[lane] = block.body_b[lane] = 1;
    block.body_b[0] = 0;
    block.moves_b = 1;
    block.placed = 1;
    block.point_count = 2;
    block.bounces = true;
    set_lane(block.normal, 0, Vec<2>{{0.0f, 1.0f}});
    set_lane(block.mass_b.inverse_mass, 0, 1.0f);
    set_lane(extra.restitution, 0, 0.5f);
    motions[0].velocity = {{0.0f, -2.0f}};
  }

  void add_point(int point, float gap) {
    set_lane(block.points[point].gap, 0, gap);
    set_lane(block.points[point].normal_mass, 0, 1.0f);
  }

  void bounce() {
    const StepContext<2> context = make_step_context<2>(1.0f / 60.0f, {{0.0f, 0.0f}}, Tuning{});
    ContactKernels<2, 4>::bounce(context, {&block, &block + 1, motions.data(), 1, false});
  }
};

TEST(Bounces, ThrowBackWhatArrives) {
  FallingBody falling;
  falling.add_point(0, 0.0f);
  falling.bounce();
  EXPECT_TRUE(falling.block.bounced);
  EXPECT_NEAR(falling.motions[0].velocity[1], 1.0f, 1.0e-6f);
}

TEST(Bounces, AskOfWhatIsStillFarNothing) {
  FallingBody falling;
  falling.add_point(0, 0.1f);
  falling.add_point(1, 0.1f);
  falling.bounce();
  EXPECT_FALSE(falling.block.bounced);
  EXPECT_EQ(falling.motions[0].velocity[1], -2.0f);
}

// Else the block would be swept again, and again nothing would come of it.
TEST(Bounces, AreOfNoPointThatALaneDoesNotHave) {
  FallingBody falling;
  falling.add_point(0, 0.1f);
  falling.bounce();
  EXPECT_FALSE(falling.block.bounced);
  EXPECT_EQ(falling.motions[0].velocity[1], -2.0f);
}

}  // namespace cycloid::solver
