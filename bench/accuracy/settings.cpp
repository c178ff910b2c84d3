#include "bench/accuracy/settings.hpp"

#include <algorithm>
#include <stdexcept>

#include "bench/trials/methods.hpp"
#include "scenes/accuracy.hpp"

namespace cycloid::accuracy {

static const trials::Method* find_method(std::string_view name) {
  for (const trials::Method& method : trials::methods())
    if (name == method.name) return &method;
  return nullptr;
}

static const solver::Tuning& published_tuning(const std::string& name) {
  const trials::Method* method = find_method(name);
  if (method == nullptr) throw std::logic_error("there is no method " + name);
  return method->tuning;
}

std::string name_of(const Setting& setting) {
  std::string name = setting.method + ' ' + std::to_string(setting.substeps) + 'x' +
                     std::to_string(setting.sweeps);
  if (setting.relax_sweeps > 0) name += '+' + std::to_string(setting.relax_sweeps);
  return name;
}

bool is_method(std::string_view method) {
  return find_method(method) != nullptr;
}

Setting published(const std::string& method) {
  const solver::Tuning& tuning = published_tuning(method);
  return {method, tuning.substeps, tuning.sweeps, tuning.relax_sweeps};
}

bool has_relax_sweeps(const std::string& method) {
  return published_tuning(method).stabilisation == solver::Stabilisation::kSoft;
}

solver::Tuning tuning_of(const Setting& setting, const solver::Tuning& scene) {
  const solver::Tuning& published = published_tuning(setting.method);
  solver::Tuning tuning = trials::with_method(scene, published);
  tuning.substeps = setting.substeps;
  tuning.sweeps = setting.sweeps;
  tuning.relax_sweeps = setting.relax_sweeps;
  const std::uint32_t of = std::max(published.sweeps, std::uint32_t{1});
  tuning.position_sweeps = (published.position_sweeps * setting.sweeps + of - 1) / of;
  return tuning;
}

std::uint64_t sweeps_per_tick(const solver::Tuning& tuning) {
  return std::uint64_t{tuning.substeps} *
         (tuning.sweeps + tuning.relax_sweeps + tuning.position_sweeps);
}

scenes::Scene with_setting(scenes::Scene scene, const Setting& setting) {
  scene.tuning = tuning_of(setting, scenes::tuning_of(scene));
  scene.accuracy = {};  // The choice that it stores would go before the setting.
  return scene;
}

/// The list, or the one number where it is empty.
static std::vector<std::uint32_t> list_or(const std::vector<std::uint32_t>& list,
                                          std::uint32_t otherwise) {
  return list.empty() ? std::vector<std::uint32_t>{otherwise} : list;
}

/// Every setting of one method.
static void add_settings(const GridLists& lists, const std::string& method,
                         std::vector<Setting>& settings) {
  const Setting own = published(method);
  const bool relaxes = has_relax_sweeps(method);
  const auto relax = relaxes ? list_or(lists.relax_sweeps, own.relax_sweeps)
                             : std::vector<std::uint32_t>{own.relax_sweeps};
  for (const std::uint32_t substeps : list_or(lists.substeps, own.substeps))
    for (const std::uint32_t sweeps : list_or(lists.sweeps, own.sweeps))
      for (const std::uint32_t relax_sweeps : relax) {
        const Setting setting{method, substeps, sweeps, relax_sweeps};
        if (std::find(settings.begin(), settings.end(), setting) == settings.end())
          settings.push_back(setting);
      }
}

std::vector<Setting> grid(const GridLists& lists) {
  std::vector<std::string> methods = lists.methods;
  if (methods.empty())
    for (const trials::Method& method : trials::methods()) methods.emplace_back(method.name);
  std::vector<Setting> settings;
  for (const std::string& method : methods) add_settings(lists, method, settings);
  return settings;
}

}  // namespace cycloid::accuracy
