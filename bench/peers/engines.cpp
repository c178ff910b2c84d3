#include "bench/peers/box2d3_world.hpp"
#include "bench/peers/box2d_world.hpp"
#include "bench/peers/bullet_world.hpp"
#include "bench/peers/ode_world.hpp"
#include "bench/peers/our_world.hpp"

namespace cycloid::peers {

template <>
std::span<const EngineKind<2>> engines<2>() {
  static constexpr EngineKind<2> kEngines[] = {
      {"ours", 0, make_our_world<2>},
      {"Box2D 2.4.1", 8, make_box2d_world},
#ifdef CYCLOID_BOX2D3
      {"Box2D " CYCLOID_BOX2D3, 4, make_box2d3_world},
#endif
  };
  return kEngines;
}

template <>
std::span<const EngineKind<3>> engines<3>() {
  static constexpr EngineKind<3> kEngines[] = {{"ours", 0, make_our_world<3>},
                                               {"Bullet 3.24", 10, make_bullet_world},
                                               {"ODE 0.16", 20, make_ode_world}};
  return kEngines;
}

}  // namespace cycloid::peers
