#pragma once

#include <memory>

#include "cli/sim/pipe.hpp"
#include "cli/sim/settings.hpp"

namespace cycloid::sim {

/// A connection that begins now, with faults of its own drawn within the settings; none where the
/// faults are over.
/// @param random  Of whoever connects, so that others' connections shift nothing.
std::shared_ptr<Wire> make_wire(const NetworkSettings& network, Random& random,
                                Chronicle& chronicle);

}  // namespace cycloid::sim
