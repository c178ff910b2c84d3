#pragma once

#include "scenes/scene.hpp"

namespace cycloid::scenes {

// Scenes in which methods fail, one function each; docs/stability.md says which and why. Gravity is
// 10 m/s^2 and nothing sleeps unless a function says otherwise.

Scene trial_ball_and_chain();
Scene trial_chain_100();
Scene trial_chain_1000();
Scene trial_chain_50000();
Scene trial_bridge();
Scene trial_joint_grid();
Scene trial_joint_grid_full();
Scene trial_stretched_chain();
Scene trial_motor_at_limit();
Scene trial_fighting_motors();
Scene trial_gear_loop();
Scene trial_elastic_grid();
Scene trial_cradle();
Scene trial_ragdolls();
Scene trial_rod_forwards();
Scene trial_rod_backwards();
Scene trial_ramp_sticks();
Scene trial_ramp_slides();
Scene trial_shot_200();
Scene trial_shot_1000();
Scene trial_spinning_rod();
Scene trial_corner_30();
Scene trial_corner_5();
Scene trial_rolling_wheel();
Scene trial_handle();
Scene trial_needle();
Scene trial_duplicate_points();
Scene trial_heavy_10();
Scene trial_heavy_100();
Scene trial_heavy_1000();
Scene trial_stack_10();
Scene trial_stack_20();
Scene trial_stack_30();
Scene trial_pyramid();
Scene trial_heavy_apexes();
Scene trial_thin_ground();
Scene trial_thick_ground();
Scene trial_pole_25();
Scene trial_pole_5();
Scene trial_tall_box();
Scene trial_card_house();
Scene trial_arch();
Scene trial_overlap();
Scene trial_confined();
Scene trial_dropped_load();
Scene trial_dominoes();
Scene trial_far_stack();
Scene trial_marble();
Scene trial_pebble();
Scene trial_reversed();
Scene trial_rush();
Scene trial_substeps_change();

// Parts of them.

Scene trial_scene(const char* name, const char* summary);
/// A scene of the catalogue as a trial: nobody acts on it, and nothing sleeps.
Scene quiet(Scene scene, const char* name);
/// A square of side 2 `half` m.
SceneBody trial_box(float x, float y, float half, float density);

}  // namespace cycloid::scenes
