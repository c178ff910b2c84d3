#include "solver/collision/box_set.hpp"

namespace cycloid::solver {

/// Beyond so many, and a share of all, a tree is faster than rows.
static constexpr std::uint32_t kLooseMax = 256;
static constexpr std::uint32_t kLooseShare = 16;

template <int D>
void BoxSet<D>::clear() {
  boxes_.clear();
  home_.clear();
  rows_.clear();
  loose_ = 0;
  count_ = 0;
  leaves_.clear();
  tree_.build(leaves_);
}

template <int D>
void BoxSet<D>::write(std::uint32_t place, std::uint32_t id, const Bounds<D>& box) {
  Row& row = rows_[place / 4];
  const int lane = static_cast<int>(place % 4);
  row.boxes.set(lane, box);
  row.id[lane] = id;
  home_[id] = place;
}

template <int D>
void BoxSet<D>::put(std::uint32_t id, const Bounds<D>& box) {
  if (id >= home_.size()) {
    home_.resize(id + 1, kAbsent);
    boxes_.resize(id + 1);
  }
  boxes_[id] = box;
  if (home_[id] == kAbsent) ++count_;
  if (home_[id] < kInTree) return write(home_[id], id, box);
  if (loose_ % 4 == 0) rows_.push_back({BoundsRow<D>::empty(), {}});
  write(loose_++, id, box);
}

/// The last of the rows moves into the place.
template <int D>
void BoxSet<D>::take_out(std::uint32_t place) {
  --loose_;
  const std::uint32_t last = rows_[loose_ / 4].id[loose_ % 4];
  if (place != loose_) write(place, last, boxes_[last]);
  if (loose_ % 4 == 0) {
    rows_.pop_back();
    return;
  }
  rows_.back().boxes.clear(static_cast<int>(loose_ % 4));
}

template <int D>
void BoxSet<D>::remove(std::uint32_t id) {
  if (!contains(id)) return;
  const std::uint32_t home = home_[id];
  if (home != kInTree) take_out(home);
  home_[id] = kAbsent;
  --count_;
}

template <int D>
void BoxSet<D>::settle() {
  const std::uint32_t share = count_ / kLooseShare;
  if (loose_ <= (share > kLooseMax ? share : kLooseMax)) return;
  leaves_.clear();
  for (std::uint32_t id = 0; id < home_.size(); ++id) {
    if (home_[id] == kAbsent) continue;
    leaves_.push_back({boxes_[id], id});
    home_[id] = kInTree;
  }
  tree_.build(leaves_);
  rows_.clear();
  loose_ = 0;
}

template class BoxSet<2>;
template class BoxSet<3>;

}  // namespace cycloid::solver
