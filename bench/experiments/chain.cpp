#include <cmath>
#include <string>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

using namespace solver;

/// `links` rods of 1 kg and 1 m that hang from the origin on pins, the last of mass `tip`, at rest.
struct Chain {
  World<2> world;
  std::vector<JointId> pins;

  Chain(int links, double tip, const Tuning& tuning, bool upright) : world(make_world(tuning)) {
    ShapeDef<2> rod = box(0.05, 0.4);
    rod.filter.group = -1;
    BodyId before = add_point(world, 0.0, 0.0);
    for (int i = 0; i < links; ++i) {
      const double mass = i + 1 == links ? tip : 1.0;
      const BodyId link = upright ? add(world, rod, 0.0, -0.5 - i, mass)
                                  : add(world, rod, (0.5 + i) * 0.6, -(0.5 + i) * 0.8, mass);
      JointDef<2> pin;
      pin.body_a = before;
      pin.body_b = link;
      const float x = upright ? 0.0f : 0.3f;
      const float y = upright ? 0.5f : 0.4f;
      if (i > 0) pin.anchor_a = {{x, -y}};
      pin.anchor_b = {{-x, y}};
      pins.push_back(require(world.create_joint(pin)));
      before = link;
    }
  }

  /// Largest speed at which two anchors of a pin part, m/s.
  double parting() const {
    double fastest = 0.0;
    for (const Joint<2>& joint : world.state().joints) {
      const Body<2>& a = world.state().bodies[joint.body_a];
      const Body<2>& b = world.state().bodies[joint.body_b];
      const Vec<2> r_a = rotate(a.rotation, joint.anchor_a);
      const Vec<2> r_b = rotate(b.rotation, joint.anchor_b);
      const Vec<2> speed =
          (b.velocity + spin_cross(b.spin, r_b)) - (a.velocity + spin_cross(a.spin, r_a));
      fastest = std::max(fastest, static_cast<double>(length(speed)));
    }
    return fastest;
  }
};

/// Velocities alone: one sweep, nothing corrected, nothing kept.
static Tuning one_solve(JointSolver solver, std::uint32_t sweeps) {
  Tuning tuning = velocities_only(sweeps, Order::kId);
  tuning.joint_solver = solver;
  return tuning;
}

static void check_hanging(int links, double ratio, Report& report) {
  const std::string name = " of " + std::to_string(links) + " links, tip " +
                           std::to_string(static_cast<int>(ratio)) + ":1";
  Chain direct(links, ratio, one_solve(JointSolver::kDirect, 1), true);
  step(direct.world);
  report.expect("after one direct solve nothing parts in a chain" + name + ", in g h",
                "methods 4 #44; Baraff 1996", 0.0, direct.parting() / kTickSpeed, 1.0e-3);
  const double weight = (links - 1 + ratio) * kTickSpeed;
  const Joint<2>& top = direct.world.state().joints[0];
  const double tension =
      std::hypot(static_cast<double>(top.impulse[0]), static_cast<double>(top.impulse[1]));
  report.expect("and its top pin carries the weight" + name, "statics", 1.0, tension / weight,
                1.0e-4);
}

Report chain() {
  Report report{"chain", {}, {}};
  for (const int links : {10, 40})
    for (const double ratio : {1.0, 100.0, 1.0e5}) check_hanging(links, ratio, report);

  Figure figure{"chain-direct",
                "A chain of 10 links, tip 100:1: sweeps against one direct solve",
                "sweeps",
                "fastest pin / (g h)",
                true,
                true,
                {}};
  Curve swept{"sweeps", {}};
  for (const int sweeps : {1, 2, 4, 8, 16, 32, 64, 128, 256, 512}) {
    Chain chain(10, 100.0, one_solve(JointSolver::kIterated, static_cast<std::uint32_t>(sweeps)),
                false);
    step(chain.world);
    swept.points.emplace_back(sweeps, chain.parting() / kTickSpeed);
  }
  Chain direct(10, 100.0, one_solve(JointSolver::kDirect, 1), false);
  step(direct.world);
  Curve solved{"one direct solve", {}};
  for (const double sweeps : {1.0, 512.0})
    solved.points.emplace_back(sweeps, std::max(direct.parting() / kTickSpeed, 1.0e-9));
  figure.curves = {swept, solved};
  report.figures.push_back(figure);
  report.expect("512 sweeps leave more than one direct solve (1: yes)", "methods 4 #44", 1.0,
                swept.points.back().second > solved.points.back().second ? 1.0 : 0.0, 0.0);
  return report;
}

}  // namespace cycloid::experiments
