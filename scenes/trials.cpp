#include "scenes/trials.hpp"

#include "scenes/generators/trial_scenes.hpp"

namespace cycloid::scenes {

static constexpr Trial kTrials[] = {
    {1, "trial-heavy-on-light-10", 600, trial_heavy_10},
    {1, "trial-heavy-on-light-100", 600, trial_heavy_100},
    {1, "trial-heavy-on-light-1000", 600, trial_heavy_1000},
    {2, "trial-stack-10", 600, trial_stack_10},
    {2, "trial-stack-20", 600, trial_stack_20},
    {2, "trial-stack-30", 600, trial_stack_30},
    {3, "trial-pyramid-20", 300, trial_pyramid},
    {4, "trial-heavy-apexes", 300, trial_heavy_apexes},
    {5, "trial-400-on-thin-ground", 600, trial_thin_ground},
    {5, "trial-400-on-thick-ground", 600, trial_thick_ground},
    {6, "trial-box-on-pole-25", 300, trial_pole_25},
    {6, "trial-box-on-pole-5", 300, trial_pole_5},
    {7, "trial-tall-box", 300, trial_tall_box},
    {8, "trial-card-house", 600, trial_card_house},
    {9, "trial-arch", 600, trial_arch},
    {10, "trial-ball-and-chain", 600, trial_ball_and_chain},
    {11, "trial-chain-100", 600, trial_chain_100},
    {11, "trial-chain-1000", 600, trial_chain_1000},
    {11, "trial-chain-50000", 600, trial_chain_50000},
    {12, "trial-bridge", 600, trial_bridge},
    {13, "trial-joint-grid-30", 240, trial_joint_grid},
    {13, "trial-joint-grid-100", 240, trial_joint_grid_full},
    {14, "trial-stretched-chain", 600, trial_stretched_chain},
    {15, "trial-overlap", 240, trial_overlap},
    {15, "trial-confined", 180, trial_confined},
    {16, "trial-warm-start-removal", 300, trial_dropped_load},
    {17, "trial-sliding-rod-forwards", 60, trial_rod_forwards},
    {17, "trial-sliding-rod-backwards", 60, trial_rod_backwards},
    {18, "trial-ramp-sticks", 600, trial_ramp_sticks},
    {18, "trial-ramp-slides", 120, trial_ramp_slides},
    {19, "trial-double-domino", 600, trial_dominoes},
    {20, "trial-motor-at-limit", 300, trial_motor_at_limit},
    {20, "trial-fighting-motors", 300, trial_fighting_motors},
    {21, "trial-gear-loop", 300, trial_gear_loop},
    {22, "trial-projectile-200", 30, trial_shot_200},
    {22, "trial-projectile-1000", 30, trial_shot_1000},
    {23, "trial-spinning-rod", 60, trial_spinning_rod},
    {24, "trial-corner-30", 300, trial_corner_30},
    {24, "trial-corner-5", 300, trial_corner_5},
    {25, "trial-far-stack", 600, trial_far_stack},
    {26, "trial-marble", 300, trial_marble},
    {26, "trial-pebble", 300, trial_pebble},
    {27, "trial-substeps-change", 400, trial_substeps_change},
    {28, "trial-rolling-wheel", 300, trial_rolling_wheel},
    {29, "trial-rush", 240, trial_rush},
    {30, "trial-order", 300, trial_reversed},
    {31, "trial-cradle", 600, trial_cradle},
    {31, "trial-elastic-balls", 600, trial_elastic_grid},
    {32, "trial-dzhanibekov", 1200, trial_handle},
    {33, "trial-needle", 600, trial_needle},
    {34, "trial-duplicate-points", 120, trial_duplicate_points},
    {35, "trial-ragdoll-stress", 300, trial_ragdolls},
};

std::span<const Trial> trials() {
  return kTrials;
}

}  // namespace cycloid::scenes
