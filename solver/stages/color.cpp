#include <algorithm>
#include <bit>
#include <iterator>
#include <utility>

#include "solver/constraints/joint_row.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Places in the list of live constraints become their slots.
static void name_slots(const std::vector<LiveJoint>& live, Coloring& coloring) {
  for (int& index : coloring.order) index = live[static_cast<std::size_t>(index)].slot;
}

/// Lists the joints of which a body is awake, in slot order. @returns whether it is the list that
/// stood there before: whoever has made something of that can keep it.
template <int D, class PairOf>
static bool list_live_joints(const WorldState<D>& state, const std::vector<std::uint8_t>& awake,
                             PairOf&& pair_of, std::vector<LiveJoint>& live) {
  const std::size_t room = live.size();
  std::size_t count = 0;
  bool same = true;
  for (int i = 0; i < static_cast<int>(state.joints.size()); ++i) {
    const Joint<D>& joint = state.joints[static_cast<std::size_t>(i)];
    if (joint.kind == JointKind::kFree) continue;
    if (awake[joint.body_a] == 0 && awake[joint.body_b] == 0) continue;
    const LiveJoint found{i, pair_of(joint.body_a, joint.body_b), awake[joint.body_a] != 0,
                          awake[joint.body_b] != 0, springs_of(joint) == Springs{}};
    if (count == live.size()) live.push_back(found);
    same = same && live[count] == found;
    live[count++] = found;
  }
  live.resize(count);
  return same && count == room;
}

/// Every constraint in one line, solved one after the other.
static void list_in_order(int count, bool reverse, Coloring& coloring) {
  coloring.colors.clear();
  coloring.overflow = {0, count};
  coloring.order.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    coloring.order[static_cast<std::size_t>(i)] = reverse ? count - 1 - i : i;
}

/// No body of a constraint has a colour yet. The world may have many other bodies, that sleep.
template <class PairOf>
static void use_no_color(std::size_t count, PairOf&& pair_of, std::vector<std::uint32_t>& used) {
  constexpr std::size_t kFew = 16;
  if (used.size() <= kFew * count) return used.assign(used.size(), 0);
  for (std::size_t i = 0; i < count; ++i) {
    const MovingPair pair = pair_of(i);
    if (pair.a != kNone) used[pair.a] = 0;
    if (pair.b != kNone) used[pair.b] = 0;
  }
}

/// Takes down what the live contacts join. @returns whether it is what stood there before.
template <int D, class PairOf>
static bool take_pairs(const std::vector<LiveContact<D>>& live, PairOf&& pair_of, Workers& workers,
                       std::vector<MovingPair>& pairs) {
  Tally changes;
  if (pairs.size() != live.size()) changes.add(1);
  pairs.resize(live.size());
  workers.parallel_for(static_cast<int>(live.size()), kLookGrain, [&](Range range) {
    bool same = true;
    for (int i = range.begin; i < range.end; ++i) {
      const LiveContact<D>& contact = live[static_cast<std::size_t>(i)];
      MovingPair& pair = pairs[static_cast<std::size_t>(i)];
      const MovingPair now = pair_of(contact.body_a, contact.body_b);
      same = same && pair == now;
      pair = now;
    }
    if (!same) changes.add(1);
  });
  return changes.sum() == 0;
}

/// Gives each constraint, in order, the lowest colour that neither of its moving bodies has yet, or
/// kColorsMax where there is none.
template <class PairOf>
static void assign_colors(std::size_t count, PairOf&& pair_of, std::vector<std::uint32_t>& used,
                          Colors& colors) {
  colors.of.resize(count);
  std::fill(std::begin(colors.sizes), std::end(colors.sizes), 0);
  use_no_color(count, pair_of, used);
  for (std::size_t i = 0; i < count; ++i) {
    const MovingPair pair = pair_of(i);
    const std::uint32_t taken =
        (pair.a != kNone ? used[pair.a] : 0) | (pair.b != kNone ? used[pair.b] : 0);
    int color = std::countr_one(taken);
    if (color >= kColorsMax) color = kColorsMax;
    if (color < kColorsMax) {
      if (pair.a != kNone) used[pair.a] |= 1u << color;
      if (pair.b != kNone) used[pair.b] |= 1u << color;
    }
    colors.of[i] = static_cast<std::uint8_t>(color);
    ++colors.sizes[color];
  }
}

void sort_by_color(const Colors& colors, Coloring& coloring) {
  const int count = static_cast<int>(colors.of.size());
  int next[kColorsMax + 1];
  int at = 0;
  coloring.colors.clear();
  // Colours are taken from the lowest on, so behind one that is empty only the overflow may be.
  for (int color = 0; color < kColorsMax && colors.sizes[color] > 0; ++color) {
    next[color] = at;
    coloring.colors.push_back({at, at + colors.sizes[color]});
    at += colors.sizes[color];
  }
  next[kColorsMax] = at;
  coloring.overflow = {at, count};
  coloring.order.resize(colors.of.size());
  for (std::size_t i = 0; i < colors.of.size(); ++i)
    coloring.order[static_cast<std::size_t>(next[colors.of[i]]++)] = static_cast<int>(i);
}

/// The joints of which a body is awake, and their colouring. Where they are as they were, it is.
template <int D, class PairOf>
static void color_joints(const WorldState<D>& state, PairOf&& pair_of, StepScratch<D>& scratch) {
  std::vector<LiveJoint>& joints = scratch.live_joints;
  const bool same = list_live_joints(state, scratch.awake, pair_of, joints);
  const Order order = state.header.tuning.order;
  const bool were_colored = std::exchange(scratch.colored_joints, order == Order::kColor);
  const bool keeps = same && were_colored && order == Order::kColor;
  if (keeps) return;
  scratch.islands_solved.joints_as_listed = scratch.islands_solved.joints_as_found = false;
  if (order == Order::kColor) {
    const auto pair_of_joint = [&](std::size_t i) { return joints[i].bodies; };
    assign_colors(joints.size(), pair_of_joint, scratch.used_colors, scratch.joint_colors);
    sort_by_color(scratch.joint_colors, scratch.joint_coloring);
  } else {
    const int count = static_cast<int>(joints.size());
    list_in_order(count, order == Order::kReverse, scratch.joint_coloring);
  }
  name_slots(joints, scratch.joint_coloring);
}

/// What the live contacts join, and their colours. Where all join the same, these stay.
template <int D, class PairOf>
static void color_contacts(PairOf&& pair_of, Workers& workers, StepScratch<D>& scratch) {
  ContactColors& colors = scratch.kept->contact_colors;
  const bool same = take_pairs(scratch.live, pair_of, workers, colors.pairs);
  if (same && !colors.of.empty()) return;
  const auto pair_of_contact = [&](std::size_t i) { return colors.pairs[i]; };
  assign_colors(colors.pairs.size(), pair_of_contact, scratch.used_colors, colors);
}

/// What the live contacts join, in one line without a colour.
template <int D, class PairOf>
static void line_up_contacts(bool reverse, PairOf&& pair_of, StepScratch<D>& scratch) {
  ContactColors& colors = scratch.kept->contact_colors;
  colors.of.clear();
  std::fill(std::begin(colors.sizes), std::end(colors.sizes), 0);
  colors.pairs.clear();
  for (const LiveContact<D>& live : scratch.live)
    colors.pairs.push_back(pair_of(live.body_a, live.body_b));
  scratch.sorted_by.clear();
  list_in_order(static_cast<int>(scratch.live.size()), reverse, scratch.contact_coloring);
}

/// Greedy colouring of the joints in slot order and of the contacts in the order of their shapes;
/// or, where the tuning asks for an order, one line of each.
///
/// Reads joints, live contacts and which bodies have mass; writes the colouring of the joints, for
/// list_held whether it is as it was, and what each contact joins and its colour.
/// Serial, because each choice depends on those before, but for what contacts join; a function of
/// ids alone, so not of workers or history.
template <int D>
void color(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch) {
  const std::vector<std::uint8_t>& has_mass = scratch.kept->active_bodies.has_mass;
  const auto pair_of = [&](std::uint32_t a, std::uint32_t b) {
    return MovingPair{has_mass[a] != 0 ? a : kNone, has_mass[b] != 0 ? b : kNone};
  };
  const Order order = state.header.tuning.order;
  scratch.used_colors.resize(state.bodies.size());
  color_joints(state, pair_of, scratch);
  if (order == Order::kColor)
    color_contacts(pair_of, workers, scratch);
  else
    line_up_contacts(order == Order::kReverse, pair_of, scratch);
}

template void color(const WorldState<2>&, Workers&, StepScratch<2>&);
template void color(const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
