#pragma once

#include "bench/experiments/experiment.hpp"

namespace cycloid::experiments {

// Every experiment, by the name under which all() lists it.

Report convergence();
Report mass_ratio();
Report stacks();
Report warm_start();
Report box_on_pole();
Report explicit_matrix();
Report stabilisation();
Report friction_and_bounce();
Report sliding_rod();
Report pendulum();
Report curves();
Report motors();
Report rotation();
Report corner();
Report character();
Report chain();
Report reduction();
Report box_on_plane();
Report in_space();

}  // namespace cycloid::experiments
