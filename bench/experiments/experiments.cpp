#include <cmath>

#include "bench/experiments/reports.hpp"

namespace cycloid::experiments {

bool Check::within() const {
  return std::abs(measured - expected) <= tolerance;
}

static constexpr Experiment kExperiments[] = {
    {"convergence", "Errors shrink by a constant factor per sweep", convergence},
    {"mass-ratio", "A heavy ball on a light one: 3 r + 2 sweeps to 5 %", mass_ratio},
    {"stacks", "Equal balls in a stack: sweeps grow as the square of the height", stacks},
    {"warm-start", "Impulses kept from tick to tick: sink, overshoot and removed loads",
     warm_start},
    {"box-on-pole", "A box on two contacts: overshoot, accumulation and the block", box_on_pole},
    {"explicit-matrix", "Sequential impulses are Gauss-Seidel on J M^-1 J^T", explicit_matrix},
    {"stabilisation", "How overlap is corrected, and what it does to velocities", stabilisation},
    {"friction-and-bounce", "Slopes, restitution and energy of elastic balls", friction_and_bounce},
    {"sliding-rod", "Painleve's rod: forces do not exist, impulses do", sliding_rod},
    {"pendulum", "Period and tension of a pendulum of any amplitude", pendulum},
    {"curves", "Bead on a wire: half-pipe, cycloid, brachistochrone", curves},
    {"motors", "Motors with a limit of torque, and motor against limit", motors},
    {"rotation", "Free spin: angle, energy and angular momentum", rotation},
    {"corner", "Projecting on two planes in turn: cos^2 of the angle per sweep", corner},
    {"character", "A character's planes: sweeps, the exact solve, and walls", character},
    {"chain", "A chain solved as a tree: exact in one solve at 100,000:1", chain},
    {"reduction", "Rows that cannot act are not solved", reduction},
    {"box-on-plane", "A box in space on four and eight contacts: A is singular, the wrench is not",
     box_on_plane},
    {"in-space", "Stacks, sink and correction in space: the numbers of the plane", in_space},
};

std::span<const Experiment> all() {
  return kExperiments;
}

}  // namespace cycloid::experiments
