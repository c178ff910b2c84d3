#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <set>

#include "bench/experiments/experiment.hpp"

namespace cycloid::experiments {

/// What a failure shows of its parameter.
static void PrintTo(const Experiment& experiment, std::ostream* out) {
  *out << experiment.name;
}

class EveryExperiment : public testing::TestWithParam<Experiment> {};

TEST_P(EveryExperiment, AgreesWithItsClaims) {
  const Report report = GetParam().run();
  EXPECT_EQ(report.experiment, GetParam().name);
  EXPECT_FALSE(report.checks.empty());
  for (const Check& check : report.checks) {
    EXPECT_TRUE(check.within()) << check.claim << "\n  expected " << check.expected << " +- "
                                << check.tolerance << " (" << check.source << ")\n  measured "
                                << check.measured;
    EXPECT_FALSE(check.source.empty()) << check.claim;
  }
}

TEST_P(EveryExperiment, DrawsFiniteNamedCurves) {
  for (const Figure& figure : GetParam().run().figures) {
    EXPECT_FALSE(figure.name.empty() || figure.x_label.empty() || figure.y_label.empty());
    EXPECT_FALSE(figure.curves.empty()) << figure.name;
    for (const Curve& curve : figure.curves) {
      EXPECT_FALSE(curve.name.empty()) << figure.name;
      EXPECT_GE(curve.points.size(), 2u) << figure.name << ": " << curve.name;
      for (const auto& [x, y] : curve.points) {
        EXPECT_TRUE(std::isfinite(x) && std::isfinite(y)) << figure.name << ": " << curve.name;
        EXPECT_TRUE((!figure.log_x || x > 0.0) && (!figure.log_y || y > 0.0))
            << figure.name << ": " << curve.name << " at " << x;
      }
    }
  }
}

/// Of a test: without hyphens.
static std::string name_of(const testing::TestParamInfo<Experiment>& experiment) {
  std::string name = experiment.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, EveryExperiment, testing::ValuesIn(all().begin(), all().end()),
                         name_of);

TEST(Experiments, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const Experiment& each : all()) EXPECT_TRUE(names.insert(each.name).second) << each.name;
}

TEST(Checks, FailOutsideOfTheirToleranceAndOnNoNumber) {
  EXPECT_TRUE((Check{"", "", 1.0, 1.1, 0.11}.within()));
  EXPECT_FALSE((Check{"", "", 1.0, 1.1, 0.09}.within()));
  EXPECT_FALSE((Check{"", "", 1.0, std::numeric_limits<double>::quiet_NaN(), 1.0}.within()));
}

}  // namespace cycloid::experiments
