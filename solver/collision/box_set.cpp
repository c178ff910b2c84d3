#include "solver/collision/box_set.hpp"

#include "solver/lane_widths.hpp"

namespace cycloid::solver {

static constexpr std::uint32_t kBoxesOfRow = BoundsRow<2>::kBoxes;
/// Beyond so many boxes a small tree is faster than rows.
static constexpr std::uint32_t kRowsMax = 256;
/// Beyond so many that changed since it was made, and a share of all, the great tree is made anew.
static constexpr std::uint32_t kChangedMax = 1024;
static constexpr std::uint32_t kChangedShare = 8;

template <int D>
void BoxSet<D>::clear() {
  boxes_.clear();
  home_.clear();
  rows_.clear();
  ids_.clear();
  count_ = 0;
  leaves_.clear();
  old_.clear();
  young_.clear();
}

template <int D>
void BoxSet<D>::write(std::uint32_t place, std::uint32_t id, const Bounds<D>& box) {
  rows_[place / kBoxesOfRow].set(static_cast<int>(place % kBoxesOfRow), box);
  ids_[place] = id;
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
  if (home_[id] < kInYoung) return write(home_[id], id, box);
  const auto place = static_cast<std::uint32_t>(ids_.size());
  if (place % kBoxesOfRow == 0) rows_.push_back(BoundsRow<D>::empty());
  ids_.push_back(id);
  write(place, id, box);
}

/// The last of the rows moves into the place.
template <int D>
void BoxSet<D>::take_out(std::uint32_t place) {
  const std::uint32_t last = ids_.back();
  ids_.pop_back();
  const auto emptied = static_cast<std::uint32_t>(ids_.size());
  if (place != emptied) write(place, last, boxes_[last]);
  if (emptied % kBoxesOfRow == 0)
    rows_.pop_back();
  else
    rows_.back().clear(static_cast<int>(emptied % kBoxesOfRow));
}

template <int D>
void BoxSet<D>::remove(std::uint32_t id) {
  if (!contains(id)) return;
  const std::uint32_t home = home_[id];
  if (home < kInYoung) take_out(home);
  home_[id] = kAbsent;
  --count_;
}

/// What lies in the small tree and in rows.
template <int D>
void BoxSet<D>::list_young() {
  leaves_.clear();
  for (int rank = 0; rank < young_.size(); ++rank) {
    const std::uint32_t id = young_.leaf(rank).id;
    if (home_[id] == kInYoung) leaves_.push_back({boxes_[id], id});
  }
  for (const std::uint32_t id : ids_) leaves_.push_back({boxes_[id], id});
}

/// The boxes of leaves_ have a new home, and no other is in rows.
template <int D>
void BoxSet<D>::forget_rows(Home home) {
  for (const auto& leaf : leaves_) home_[leaf.id] = home;
  rows_.clear();
  ids_.clear();
}

template <int D>
void BoxSet<D>::settle(Workers& workers, TreeRoom<D>& room) {
  if (ids_.size() <= kRowsMax) return;
  list_young();
  const std::uint32_t share = count_ / kChangedShare;
  if (leaves_.size() <= (share > kChangedMax ? share : kChangedMax)) {
    forget_rows(kInYoung);
    young_.build(leaves_, workers, room);
    return;
  }
  leaves_.clear();
  for (std::uint32_t id = 0; id < home_.size(); ++id)
    if (home_[id] != kAbsent) leaves_.push_back({boxes_[id], id});
  forget_rows(kInOld);
  old_.build(leaves_, workers, room);
  young_.clear();
}

template <int D>
bool BoxSet<D>::search_rows(BoundsSearch<D>& search, FoundBoxes& found) const {
  const auto count = static_cast<int>(rows_.size());
  return at_widest([&]<int W>() {
    return BoundsKernels<D, W>::search_rows(rows_.data(), count, search, found);
  });
}

template class BoxSet<2>;
template class BoxSet<3>;

}  // namespace cycloid::solver
