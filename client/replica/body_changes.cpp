#include "client/replica/body_changes.hpp"

#include <algorithm>
#include <iterator>

namespace cycloid::client {

std::vector<BodyChange> BodyChanges::compare(std::span<const scenes::Pose> poses) {
  std::vector<Id> now;
  now.reserve(poses.size());
  for (const scenes::Pose& pose : poses) now.emplace_back(pose.index, pose.generation);
  std::sort(now.begin(), now.end());  // Total order: no two bodies have one index and generation.
  std::vector<Id> gone;
  std::vector<Id> came;
  std::set_difference(ids_.begin(), ids_.end(), now.begin(), now.end(), std::back_inserter(gone));
  std::set_difference(now.begin(), now.end(), ids_.begin(), ids_.end(), std::back_inserter(came));
  ids_ = std::move(now);
  std::vector<BodyChange> changes;
  for (const Id& id : gone) changes.push_back({false, id.first, id.second});
  for (const Id& id : came) changes.push_back({true, id.first, id.second});
  return changes;
}

}  // namespace cycloid::client
