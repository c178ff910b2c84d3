#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>

namespace cycloid::load {

/// Measured times, kept whole, so that a quantile is one of them and not the edge of a bucket. In
/// pieces, because a vector of ten minutes stands still for its clients while it moves.
class Samples {
 public:
  void add(double value) {
    values_.push_back(value);
    sorted_ = false;
  }
  /// The smallest value that at least `permille` / 1000 of all are not above; 0 of none.
  double quantile(std::size_t permille) {
    if (values_.empty()) return 0.0;
    if (!sorted_) std::sort(values_.begin(), values_.end());  // Total order: a clock has no NaN.
    sorted_ = true;
    const std::size_t at = (values_.size() * permille + 999) / 1000;
    return values_[std::min(values_.size(), std::max<std::size_t>(at, 1)) - 1];
  }
  /// How many are above `bound`.
  std::size_t above(double bound) const {
    const auto is_above = [bound](double value) { return value > bound; };
    return static_cast<std::size_t>(std::count_if(values_.begin(), values_.end(), is_above));
  }
  std::size_t size() const { return values_.size(); }
  void clear() { values_.clear(); }

 private:
  std::deque<double> values_;
  bool sorted_ = false;
};

}  // namespace cycloid::load
