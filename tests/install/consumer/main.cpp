#include <cinttypes>
#include <cstdio>

#include "client/join.hpp"
#include "solver/world.hpp"

namespace solver = cycloid::solver;

int main() {
  solver::WorldDef<2> def;
  def.gravity = {0.0f, -9.81f};
  solver::Result<solver::World<2>> world = solver::World<2>::create(def);
  if (!world.ok()) return 1;

  solver::ShapeDef<2> ball;
  ball.kind = solver::ShapeKind::kBall;
  ball.radius = 0.5f;
  if (!world.value().create_body({}, {&ball, 1}).ok()) return 1;
  for (int tick = 0; tick < 60; ++tick) {
    if (!world.value().step().ok()) return 1;
  }
  std::printf("tick %" PRIu64 " digest %016" PRIx64 "\n", world.value().tick(),
              world.value().digest());

  // Links the client; nobody listens on port 1, so it comes back at once.
  cycloid::client::JoinOptions nobody;
  nobody.port = 1;
  nobody.connect = std::chrono::milliseconds(200);
  return cycloid::client::join(nobody).end == cycloid::client::End::kTicks ? 1 : 0;
}
