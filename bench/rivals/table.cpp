#include "bench/rivals/table.hpp"

#include <array>

#include "bench/trials/expected.hpp"

namespace cycloid::rivals {

using accuracy::ChartPoint;
using accuracy::SceneChart;
using accuracy::Setting;

static std::vector<Setting> columns_of(const accuracy::ChartPlan& plan) {
  std::vector<Setting> columns = plan.settings;
  for (const accuracy::Contender& contender : plan.contenders) columns.push_back(contender.setting);
  return columns;
}

static const trials::Outcome* outcome_of(const SceneChart& chart, const Setting& setting) {
  for (const ChartPoint& point : chart.points)
    if (point.measured.setting == setting && point.outcome) return &*point.outcome;
  return nullptr;
}

/// How many trials a setting stands, sags in and fails: "30, 8, 5".
static std::string tally_of(const accuracy::ChartPlan& plan, const Setting& setting) {
  std::array<int, 3> counts{};
  for (const SceneChart& chart : plan.scenes)
    if (const trials::Outcome* outcome = outcome_of(chart, setting))
      ++counts[static_cast<std::size_t>(outcome->verdict)];
  return std::to_string(counts[0]) + ", " + std::to_string(counts[1]) + ", " +
         std::to_string(counts[2]);
}

std::string outcome_table(const accuracy::ChartPlan& plan) {
  const std::vector<Setting> columns = columns_of(plan);
  std::string head = "| trial | number |";
  std::string rule = "|---|---|";
  std::string tally = "| all | stand, sag, fail |";
  for (const Setting& column : columns) {
    head += ' ' + name_of(column) + " |";
    rule += "---|";
    tally += ' ' + tally_of(plan, column) + " |";
  }
  std::string text = head + '\n' + rule + '\n';
  for (const SceneChart& chart : plan.scenes) {
    if (!chart.trial) continue;
    text += "| " + chart.name.substr(sizeof "trial-" - 1) + " | " +
            trials::judge_of(*chart.trial).metric + " |";
    for (const Setting& column : columns) {
      const trials::Outcome* outcome = outcome_of(chart, column);
      text += ' ' +
              (outcome == nullptr ? "-" : trials::outcome_cell(trials::outcome_text(*outcome))) +
              " |";
    }
    text += '\n';
  }
  return text + tally + '\n';
}

}  // namespace cycloid::rivals
