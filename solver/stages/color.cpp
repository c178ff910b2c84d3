#include <bit>

#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// More colours than this would leave each with too little to share among lanes and threads.
static constexpr int kColorsMax = 28;

struct BodyPair {
  std::uint32_t a;
  std::uint32_t b;
  bool a_moves;
  bool b_moves;
};

/// Places in the list of live constraints become their slots.
static void name_slots(const std::vector<int>& live, Coloring& coloring) {
  for (int& index : coloring.order) index = live[static_cast<std::size_t>(index)];
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
static void use_no_color(int count, PairOf&& pair_of, std::vector<std::uint32_t>& used) {
  constexpr std::size_t kFew = 16;
  if (used.size() <= kFew * static_cast<std::size_t>(count)) return used.assign(used.size(), 0);
  for (int i = 0; i < count; ++i) {
    const BodyPair pair = pair_of(i);
    used[pair.a] = used[pair.b] = 0;
  }
}

/// Gives each constraint, in order, the lowest colour that neither of its moving bodies has yet.
template <class PairOf>
static void color_in_order(int count, PairOf&& pair_of, std::vector<std::uint32_t>& used,
                           std::vector<int>& color_of, Coloring& coloring) {
  int size_of[kColorsMax + 1] = {};
  color_of.resize(static_cast<std::size_t>(count));
  use_no_color(count, pair_of, used);
  for (int i = 0; i < count; ++i) {
    const BodyPair pair = pair_of(i);
    const std::uint32_t taken =
        (pair.a_moves ? used[pair.a] : 0) | (pair.b_moves ? used[pair.b] : 0);
    int color = std::countr_one(taken);
    if (color >= kColorsMax) color = kColorsMax;
    if (color < kColorsMax) {
      if (pair.a_moves) used[pair.a] |= 1u << color;
      if (pair.b_moves) used[pair.b] |= 1u << color;
    }
    color_of[static_cast<std::size_t>(i)] = color;
    ++size_of[color];
  }
  int next[kColorsMax + 1];
  int at = 0;
  coloring.colors.clear();
  for (int color = 0; color <= kColorsMax; ++color) {
    next[color] = at;
    const Range range{at, at + size_of[color]};
    if (color == kColorsMax)
      coloring.overflow = range;
    else if (size_of[color] > 0)
      coloring.colors.push_back(range);
    at = range.end;
  }
  coloring.order.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    coloring.order[static_cast<std::size_t>(next[color_of[static_cast<std::size_t>(i)]]++)] = i;
}

/// Greedy colouring of the joints in slot order and of the contacts in the order of their shapes;
/// or, where the tuning asks for an order, one line of each.
///
/// Reads joints, live contacts and which bodies have mass; writes both colourings. Serial,
/// because each choice depends on those before; a function of ids alone, so not of workers or
/// history.
template <int D>
void color(const WorldState<D>& state, StepScratch<D>& scratch) {
  const std::vector<std::uint8_t>& has_mass = scratch.active_bodies.has_mass;
  const auto moves = [&](std::uint32_t body) { return has_mass[body] != 0; };
  std::vector<int>& joints = scratch.live_joints;
  joints.clear();
  for (int i = 0; i < static_cast<int>(state.joints.size()); ++i) {
    const Joint<D>& joint = state.joints[static_cast<std::size_t>(i)];
    if (joint.kind == JointKind::kFree) continue;
    if (scratch.awake[joint.body_a] != 0 || scratch.awake[joint.body_b] != 0) joints.push_back(i);
  }
  const std::vector<LiveContact<D>>& contacts = scratch.live;
  const Order order = state.header.tuning.order;
  if (order != Order::kColor) {
    const bool reverse = order == Order::kReverse;
    list_in_order(static_cast<int>(joints.size()), reverse, scratch.joint_coloring);
    name_slots(joints, scratch.joint_coloring);
    list_in_order(static_cast<int>(contacts.size()), reverse, scratch.contact_coloring);
    return;
  }
  scratch.used_colors.resize(state.bodies.size());
  color_in_order(
      static_cast<int>(joints.size()),
      [&](int i) {
        const auto slot = static_cast<std::size_t>(joints[static_cast<std::size_t>(i)]);
        const Joint<D>& joint = state.joints[slot];
        return BodyPair{joint.body_a, joint.body_b, moves(joint.body_a), moves(joint.body_b)};
      },
      scratch.used_colors, scratch.color_of, scratch.joint_coloring);
  name_slots(joints, scratch.joint_coloring);

  color_in_order(
      static_cast<int>(contacts.size()),
      [&](int i) {
        const LiveContact<D>& contact = contacts[static_cast<std::size_t>(i)];
        return BodyPair{contact.body_a, contact.body_b, moves(contact.body_a),
                        moves(contact.body_b)};
      },
      scratch.used_colors, scratch.color_of, scratch.contact_coloring);
}

template void color(const WorldState<2>&, StepScratch<2>&);
template void color(const WorldState<3>&, StepScratch<3>&);

}  // namespace cycloid::solver
