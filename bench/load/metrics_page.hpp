#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace cycloid::load {

/// A page of Prometheus text, summed over rooms.
class MetricsPage {
 public:
  /// @throws std::system_error where nobody answers.
  static MetricsPage fetch(std::uint16_t port);
  explicit MetricsPage(const std::string& text);

  /// The sum of all series of that name; 0 of none.
  double sum(const std::string& name) const;
  /// The upper edge, in ms, of the bucket of a histogram that holds the quantile of what was
  /// counted since `before`.
  double quantile_ms(const std::string& name, double quantile, const MetricsPage& before) const;

 private:
  std::map<std::string, double> sums_;
  std::map<std::string, std::map<double, double>> buckets_;  ///< By upper edge in s, cumulative.
};

}  // namespace cycloid::load
