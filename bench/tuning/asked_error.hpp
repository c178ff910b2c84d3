#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "scenes/scene.hpp"

namespace cycloid::tuning {

/// How wrong a scene may be: a length, or a share of the size of its typical body.
struct AskedError {
  double length_m = 0.0;  ///< 0: a share is asked for.
  double percent = 0.0;   ///< 0: a length is asked for.
};

/// Reads "1mm", "0.5cm", "0.002m" or "1%": above 0, at most 1000 m or 100 %.
/// @returns nothing, and sets `mistake` to a sentence, for anything else.
std::optional<AskedError> read_asked_error(std::string_view text, std::string& mistake);

/// What the scene itself asks for; nothing where it states a method.
std::optional<AskedError> asked_by(const scenes::Scene& scene);

/// "1 mm", or "0.5 %".
std::string text_of(const AskedError& asked);

/// A length in the unit that suits it: "0.25 mm", "1.2 m".
std::string length_text(double length_m);

/// The size of a typical body, m: of all bodies that move by themselves the median of the geometric
/// mean of length and thickness: a ball's diameter, 28 mm for a card of 400 x 2 mm. 0 of none.
/// @pre the scene has no mistake.
double typical_size_m(const scenes::Scene& scene);

/// The error as a length, m. @pre the scene has no mistake.
double error_of(const AskedError& asked, const scenes::Scene& scene);

}  // namespace cycloid::tuning
