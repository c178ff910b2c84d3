#include "cli/blame.hpp"

#include <algorithm>
#include <iostream>
#include <map>

#include "cli/trace_text.hpp"

namespace cycloid::cli {

std::optional<std::uint64_t> first_difference(const Course& a, const Course& b) {
  const std::size_t common = std::min(a.digests.size(), b.digests.size());
  for (std::size_t i = 0; i < common; ++i)
    if (a.digests[i] != b.digests[i]) return a.begin + i;
  return std::nullopt;
}

/// Digests take both zeros for one, and every NaN; so the fields that explain them must, too.
static bool same_value(const std::string& a, const std::string& b) {
  const auto canonical = [](const std::string& value) {
    if (value == "-0 (0x80000000)") return std::string("0 (0x00000000)");
    const bool nan = value.starts_with("nan") || value.starts_with("-nan");
    return nan ? std::string("nan") : value;
  };
  return canonical(a) == canonical(b);
}

/// The names of what differs, in the order of `a` and then what only `b` has.
static std::vector<std::string> differing_objects(const solver::TracedPhase& a,
                                                  const solver::TracedPhase& b) {
  std::map<std::string, std::uint64_t> left;
  for (const solver::TracedObject& object : b.objects) left[object.name] = object.digest;
  std::vector<std::string> names;
  for (const solver::TracedObject& object : a.objects) {
    const auto there = left.find(object.name);
    if (there == left.end() || there->second != object.digest) names.push_back(object.name);
    if (there != left.end()) left.erase(there);
  }
  for (const solver::TracedObject& object : b.objects)
    if (left.contains(object.name)) names.push_back(object.name);
  return names;
}

/// The first phase that is not the same, or the common length.
static std::size_t first_phase(const TickTrace& a, const TickTrace& b) {
  const std::size_t common = std::min(a.phases.size(), b.phases.size());
  std::size_t i = 0;
  while (i < common && a.phases[i].at == b.phases[i].at && a.phases[i].digest == b.phases[i].digest)
    ++i;
  return i;
}

static void compare_fields(const solver::TracedPhase& a, const solver::TracedPhase& b,
                           std::size_t limit, Blame& blame) {
  const std::size_t common = std::min(a.fields.size(), b.fields.size());
  for (std::size_t i = 0; i < common && blame.fields.size() < limit; ++i) {
    if (same_value(a.fields[i].value, b.fields[i].value)) continue;
    blame.fields.push_back(
        {a.fields[i].object, a.fields[i].name, a.fields[i].value, b.fields[i].value});
  }
}

static bool has_object(const solver::TracedPhase& phase, const std::string& name) {
  return std::ranges::any_of(phase.objects,
                             [&](const auto& object) { return object.name == name; });
}

Blame blame_tick(const Suspect& a, const Suspect& b, std::uint64_t tick, std::size_t fields) {
  const TickTrace trace_a = a.trace(tick, {true, ""});
  const TickTrace trace_b = b.trace(tick, {true, ""});
  Blame blame;
  blame.tick = tick;
  blame.digest_a = hex16(trace_a.digest);
  blame.digest_b = hex16(trace_b.digest);
  const std::size_t i = first_phase(trace_a, trace_b);
  blame.phases_equal = i;
  if (i == trace_a.phases.size() || i == trace_b.phases.size()) {
    const bool same = trace_a.phases.size() == trace_b.phases.size();
    blame.other = same ? "every phase of the tick is equal"
                       : "one has no phase after the first " + std::to_string(i) + ": " +
                             (i == trace_a.phases.size() ? a : b).name() + ": " +
                             (i == trace_a.phases.size() ? trace_a : trace_b).fault;
    return blame;
  }
  const solver::TracedPhase& phase_a = trace_a.phases[i];
  const solver::TracedPhase& phase_b = trace_b.phases[i];
  blame.at = phase_a.at;
  if (phase_a.at != phase_b.at) {
    blame.other = "the phases are not the same: " + point_text(phase_a.at) + " against " +
                  point_text(phase_b.at);
    return blame;
  }
  blame.objects = differing_objects(phase_a, phase_b);
  if (blame.objects.empty()) return blame;
  const std::string& object = blame.objects.front();
  for (const auto& [phase, suspect] : {std::pair(&phase_a, &b), std::pair(&phase_b, &a)}) {
    if (has_object(*phase, object)) continue;
    blame.other = "only " + suspect->name() + " has " + object;
    return blame;
  }
  const TickTrace named_a = a.trace(tick, {false, object});
  const TickTrace named_b = b.trace(tick, {false, object});
  compare_fields(named_a.phases.at(i), named_b.phases.at(i), fields, blame);
  return blame;
}

Json to_json(const Blame& blame) {
  Json fields = Json::array();
  for (const solver::Difference& field : blame.fields)
    fields.push_back({{"field", field.field}, {"a", field.value_a}, {"b", field.value_b}});
  Json json = {{"tick", blame.tick},
               {"digest_a", blame.digest_a},
               {"digest_b", blame.digest_b},
               {"phase", nullptr},
               {"substep", nullptr},
               {"sweep", nullptr},
               {"phases_equal", blame.phases_equal},
               {"object", nullptr},
               {"objects", blame.objects},
               {"fields", fields},
               {"other", blame.other}};
  if (!blame.objects.empty()) json["object"] = blame.objects.front();
  if (!blame.at) return json;
  json["phase"] = solver::phase_name(blame.at->phase);
  if (blame.at->substep != solver::kNone) json["substep"] = blame.at->substep;
  if (blame.at->sweep != solver::kNone) json["sweep"] = blame.at->sweep;
  return json;
}

void print_blame(const Blame& blame, const std::string& name_a, const std::string& name_b) {
  std::cout << "first tick that differs: " << blame.tick << '\n'
            << "  " << blame.digest_a << "  " << name_a << '\n'
            << "  " << blame.digest_b << "  " << name_b << '\n';
  if (blame.at) {
    std::cout << "first phase that differs: " << point_text(blame.at.value()) << " (after "
              << blame.phases_equal << " equal ones)\n";
  }
  if (!blame.objects.empty()) {
    std::cout << "first object that differs: " << blame.objects.front();
    if (blame.objects.size() > 1) std::cout << ", of " << blame.objects.size();
    std::cout << '\n';
  }
  for (const solver::Difference& field : blame.fields) {
    std::cout << "  " << field.object << ": " << field.field << ": " << field.value_a << " against "
              << field.value_b << '\n';
  }
  if (!blame.other.empty()) std::cout << blame.other << '\n';
}

}  // namespace cycloid::cli
