#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene.hpp"

namespace cycloid::accuracy {

/// One way to solve a scene: a method of `trials::methods()`, and how much of it.
struct Setting {
  std::string method = "soft-step";
  std::uint32_t substeps = 4;
  std::uint32_t sweeps = 1;        ///< Per substep.
  std::uint32_t relax_sweeps = 1;  ///< Per substep; 0 where the method has none.
  friend bool operator==(const Setting&, const Setting&) = default;
};

/// "soft-step 4x1+1": substeps, sweeps and, where the method has them, relax sweeps.
std::string name_of(const Setting& setting);

/// Whether there is a method of this name.
bool is_method(std::string_view method);

/// The setting as the method's author gives it. @pre is_method(method)
Setting published(const std::string& method);

/// Whether the number changes anything: only soft methods have relax sweeps.
bool has_relax_sweeps(const std::string& method);

/// `trials::with_method` with the setting's sweeps. Position sweeps, of methods that have them,
/// grow with the sweeps in the proportion in which the method is published, rounded up.
/// @pre is_method(setting.method)
solver::Tuning tuning_of(const Setting& setting, const solver::Tuning& scene);

/// Sweeps over the constraints in a tick, of all kinds.
std::uint64_t sweeps_per_tick(const solver::Tuning& tuning);

/// The scene solved this way. @pre is_method(setting.method)
scenes::Scene with_setting(scenes::Scene scene, const Setting& setting);

/// What `grid` crosses. An empty list leaves the published numbers.
struct GridLists {
  std::vector<std::string> methods;  ///< None: every method.
  std::vector<std::uint32_t> substeps;
  std::vector<std::uint32_t> sweeps;
  std::vector<std::uint32_t> relax_sweeps;  ///< Of methods that have them.
};

/// Every setting of the lists, method after method, without doubles. @pre all are methods.
std::vector<Setting> grid(const GridLists& lists);

}  // namespace cycloid::accuracy
