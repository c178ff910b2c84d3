#pragma once

#include <ode/ode.h>

#include <deque>
#include <vector>

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::peers {

/// What a shape is made of, and what decides how it meets others. Lives as long as its geom.
struct OdeShape {
  solver::Material material;
  solver::Filter filter;
  std::vector<dReal> planes;  ///< Of a hull: four numbers each.
  std::vector<dReal> points;  ///< Of a hull: three numbers each.
  std::vector<unsigned int> polygons;
};

/// Where ODE keeps things, and what belongs to them.
struct OdePlace {
  dWorldID world;
  dSpaceID space;
  std::deque<OdeShape>& shapes;
};

/// The body with its mass, or null for one that never moves.
dBodyID add_ode_body(const solver::Body<3>& body, float tick_s, dWorldID world);

/// Every shape of the body. @returns false where one is of a kind that is not there.
bool add_ode_geoms(const solver::WorldState<3>& state, const solver::Body<3>& body, dBodyID owner,
                   const OdePlace& place, std::vector<dGeomID>& geoms);

/// Bodies a and b of a joint: where they are, and what they are; null is the world.
struct OdePair {
  solver::Pose<3> pose_a;
  dBodyID a;
  dBodyID b;
};

/// The joint, or null for a kind that is not there.
dJointID add_ode_joint(const solver::Joint<3>& joint, const OdePair& pair, dWorldID world);

}  // namespace cycloid::peers
