#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenes/catalogue.hpp"
#include "scenes/scene.hpp"

namespace cycloid::scenes {

/// Whether the scene asks for an accuracy instead of a method. One with a stored choice and no
/// error counts too, so that it is found wrong and not ignored.
bool states_accuracy(const Scene& scene);

/// Whether it asks for one and has no choice that rests on this solver version.
bool lacks_choice(const Scene& scene);

/// Whether a field of solver::Tuning, by its name, belongs to a method, and so to the choice. The
/// others say how the scene is meant: when bodies sleep, whether they are stopped in flight, when
/// they bounce, and all of particles.
bool is_of_method(std::string_view field);

/// What one tuning says of how the scene is meant, with the method of another.
solver::Tuning solved_by(const solver::Tuning& scene, const solver::Tuning& method);

/// What the scene's world runs with: its tuning or, where it asks for an accuracy, that solved by
/// the stored choice.
solver::Tuning tuning_of(const Scene& scene);

/// Where a field of that comes from, as the path of a mistake.
std::string tuning_path(const Scene& scene, const std::string& field);

/// Stores a choice of this solver version, and takes out of the scene's own tuning what now is in
/// the choice. @pre states_accuracy(scene). Afterwards tuning_of(scene) has the method of `tuning`.
void store_choice(Scene& scene, const solver::Tuning& tuning);

/// Appends the mistakes of /accuracy; of the choice's values `build` says them.
void check_accuracy(const Scene& scene, Untuned untuned, std::vector<Mistake>& mistakes);

}  // namespace cycloid::scenes
