#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace cycloid::experiments {

/// One number that a talk claims or a formula gives, and what the solver does.
struct Check {
  std::string claim;   ///< With its unit, as read aloud.
  std::string source;  ///< The talk or the formula.
  double expected;
  double measured;
  double tolerance;  ///< Absolute, in the unit of the claim.

  /// False also where the measured number is not one.
  bool within() const;
};

/// A line of a figure: points (x, y) of one curve.
struct Curve {
  std::string name;
  std::vector<std::pair<double, double>> points;
};

/// Data of a figure; drawing it is for others.
struct Figure {
  std::string name;  ///< File stem.
  std::string title;
  std::string x_label;
  std::string y_label;
  bool log_x = false;
  bool log_y = false;
  std::vector<Curve> curves;
};

/// What one experiment found.
struct Report {
  std::string experiment;
  std::vector<Check> checks;
  std::vector<Figure> figures;

  void expect(std::string claim, std::string source, double expected, double measured,
              double tolerance) {
    checks.push_back({std::move(claim), std::move(source), expected, measured, tolerance});
  }
};

/// An experiment is a pure function: it makes its worlds, steps them and measures.
struct Experiment {
  const char* name;
  const char* summary;
  Report (*run)();
};

/// All of them, in a fixed order.
std::span<const Experiment> all();

}  // namespace cycloid::experiments
