#include "client/c/guard.hpp"

#include <algorithm>

#include "solver/version.hpp"
#include "solver/world.hpp"

namespace cycloid::client {

static std::string& last_error() {
  static thread_local std::string text;
  return text;
}

cycloid_status failed(cycloid_status status, std::string_view reason) noexcept {
  try {
    last_error() = reason;
  } catch (...) {  // Without memory for the reason the status has to do.
    last_error().clear();
  }
  return status;
}

cycloid_status no_scene(const std::string& name, const scenes::Loaded& loaded) {
  const scenes::Mistake& first = loaded.mistakes.front();
  const std::string where = first.path.empty() ? "" : first.path + ": ";
  return failed(CYCLOID_SCENE, name + ": " + where + first.reason);
}

std::uint32_t copy_text(const std::string& text, char* into, std::uint32_t capacity) noexcept {
  if (into != nullptr && capacity != 0) {
    const std::size_t bytes = std::min<std::size_t>(text.size(), capacity - 1);
    std::memcpy(into, text.data(), bytes);
    into[bytes] = '\0';
  }
  return static_cast<std::uint32_t>(text.size() + 1);
}

template <class From, class To>
static cycloid_status copy_all(const std::vector<From>& all, To* into, std::uint32_t capacity,
                               std::uint32_t* count) {
  static_assert(sizeof(From) == sizeof(To));
  if (count == nullptr) return failed(CYCLOID_INVALID, "count: null");
  *count = static_cast<std::uint32_t>(all.size());
  if (all.empty()) return CYCLOID_OK;
  if (into == nullptr || all.size() > capacity) {
    return failed(CYCLOID_BUFFER, "capacity: " + std::to_string(capacity) + ", here are " +
                                      std::to_string(all.size()));
  }
  std::memcpy(into, all.data(), all.size() * sizeof(To));
  return CYCLOID_OK;
}

cycloid_status copy_out(const std::vector<cycloid_pose>& all, cycloid_pose* into,
                        std::uint32_t capacity, std::uint32_t* count) {
  return copy_all(all, into, capacity, count);
}

cycloid_status copy_out(const std::vector<std::byte>& all, std::uint8_t* into,
                        std::uint32_t capacity, std::uint32_t* count) {
  return copy_all(all, into, capacity, count);
}

std::vector<cycloid_pose> to_c(const std::vector<scenes::Pose>& poses) {
  std::vector<cycloid_pose> result;
  result.reserve(poses.size());
  for (const scenes::Pose& pose : poses) {
    cycloid_pose& to = result.emplace_back();
    to.index = pose.index;
    to.generation = pose.generation;
    std::copy(pose.position.begin(), pose.position.end(), to.position);
    std::copy(pose.rotation.begin(), pose.rotation.end(), to.rotation);
  }
  return result;
}

scenes::SeatInput from_c(const cycloid_input& input) {
  scenes::SeatInput result;
  std::copy(input.axes, input.axes + 4, result.axes.begin());
  result.buttons = input.buttons;
  return result;
}

}  // namespace cycloid::client

using namespace cycloid;

uint32_t cycloid_last_error(char* text, uint32_t capacity) {
  return client::copy_text(client::last_error(), text, capacity);
}
uint32_t cycloid_abi_version(void) {
  return CYCLOID_ABI_VERSION;
}
uint32_t cycloid_solver_version(void) {
  return solver::kSolverVersion;
}
