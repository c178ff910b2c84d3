#include "bench/tuning/asked_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <locale>
#include <sstream>
#include <utility>
#include <vector>

#include "bench/tuning/passage.hpp"

namespace cycloid::tuning {

static constexpr double kLengthMaxM = 1000.0;
static constexpr double kPercentMax = 100.0;

static std::string refusal(std::string_view text, const char* why) {
  return "'" + std::string(text) + "' " + why +
         ": write a length as 1mm, 0.5cm or 0.002m, or a share as 1%";
}

std::optional<AskedError> read_asked_error(std::string_view text, std::string& mistake) {
  static constexpr std::array<std::pair<std::string_view, double>, 4> kUnits = {
      {{"mm", 1.0e-3}, {"cm", 1.0e-2}, {"m", 1.0}, {"%", 0.0}}};
  const std::size_t digits = std::min(text.find_first_not_of("0123456789.eE+-"), text.size());
  const std::string_view unit = text.substr(digits);
  // A stream of the classic locale: libc++ 19 has no from_chars of a double, and strtod follows the
  // user's.
  std::istringstream stream{std::string(text.substr(0, digits))};
  stream.imbue(std::locale::classic());
  double value = 0.0;
  if (!(stream >> value) || stream.peek() != std::istringstream::traits_type::eof()) {
    mistake = refusal(text, "is no number with a unit");
    return {};
  }
  for (const auto& [name, scale] : kUnits) {
    if (unit != name) continue;
    const bool share = scale == 0.0;
    const double asked = share ? value : value * scale;
    if (asked > 0.0 && asked <= (share ? kPercentMax : kLengthMaxM))
      return share ? AskedError{0.0, asked} : AskedError{asked, 0.0};
    mistake = refusal(text, "has to be above 0 and at most 1000m or 100%");
    return {};
  }
  mistake = refusal(text, unit.empty() ? "has no unit" : "has a unit that is not known here");
  return {};
}

std::optional<AskedError> asked_by(const scenes::Scene& scene) {
  const scenes::SceneAccuracy& accuracy = scene.accuracy;
  if (accuracy.error_m == 0.0f && accuracy.error_percent == 0.0f) return {};
  return AskedError{static_cast<double>(accuracy.error_m),
                    static_cast<double>(accuracy.error_percent)};
}

static std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string text_of(const AskedError& asked) {
  return asked.percent > 0.0 ? number_text(asked.percent) + " %" : length_text(asked.length_m);
}

std::string length_text(double length_m) {
  return length_m < 1.0 ? number_text(1.0e3 * length_m) + " mm" : number_text(length_m) + " m";
}

double typical_size_m(const scenes::Scene& scene) {
  std::vector<double> sizes;
  for (const MovingBody& body : moving_bodies(scene))
    if (body.extent_m > 0.0 && body.thickness_m > 0.0)
      sizes.push_back(2.0 * std::sqrt(body.extent_m * body.thickness_m));
  if (sizes.empty()) return 0.0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

double error_of(const AskedError& asked, const scenes::Scene& scene) {
  return asked.percent > 0.0 ? 0.01 * asked.percent * typical_size_m(scene) : asked.length_m;
}

}  // namespace cycloid::tuning
