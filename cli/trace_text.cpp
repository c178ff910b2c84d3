#include "cli/trace_text.hpp"

#include <charconv>

namespace cycloid::cli {

using solver::kNone;

std::optional<solver::Phase> phase_of(const std::string& name) {
  for (std::uint32_t i = 0; i < solver::kPhases; ++i)
    if (name == solver::phase_name(solver::Phase(i))) return solver::Phase(i);
  return std::nullopt;
}

static Json to_json(const solver::TracedPhase& phase) {
  Json json = {{"phase", solver::phase_name(phase.at.phase)},
               {"substep", nullptr},
               {"sweep", nullptr},
               {"digest", hex16(phase.digest)}};
  if (phase.at.substep != kNone) json["substep"] = phase.at.substep;
  if (phase.at.sweep != kNone) json["sweep"] = phase.at.sweep;
  if (!phase.objects.empty()) {
    Json objects = Json::array();
    for (const solver::TracedObject& object : phase.objects)
      objects.push_back({{"object", object.name}, {"digest", hex16(object.digest)}});
    json["objects"] = std::move(objects);
  }
  if (!phase.fields.empty()) {
    Json fields = Json::array();
    for (const solver::TracedField& field : phase.fields)
      fields.push_back({{"object", field.object}, {"field", field.name}, {"value", field.value}});
    json["fields"] = std::move(fields);
  }
  return json;
}

Json to_json(const TickTrace& trace) {
  Json phases = Json::array();
  for (const solver::TracedPhase& phase : trace.phases) phases.push_back(to_json(phase));
  return {{"digest", hex16(trace.digest)}, {"fault", trace.fault}, {"phases", std::move(phases)}};
}

/// Throws where it is no digest, as the JSON library does where a member is missing.
static std::uint64_t digest_from(const Json& json) {
  const std::string& text = json.get_ref<const std::string&>();
  std::uint64_t digest = 0;
  const char* end = text.data() + text.size();
  if (std::from_chars(text.data(), end, digest, 16).ptr != end || text.size() != 16)
    throw Failure(kExitCorrupt, "no digest: " + text);
  return digest;
}

static solver::TracedPhase phase_from(const Json& json) {
  solver::TracedPhase phase;
  const std::optional<solver::Phase> name = phase_of(json.at("phase").get<std::string>());
  if (!name) throw Failure(kExitCorrupt, "no phase: " + json.at("phase").get<std::string>());
  phase.at.phase = *name;
  if (!json.at("substep").is_null()) phase.at.substep = json.at("substep").get<std::uint32_t>();
  if (!json.at("sweep").is_null()) phase.at.sweep = json.at("sweep").get<std::uint32_t>();
  phase.digest = digest_from(json.at("digest"));
  if (json.contains("objects"))
    for (const Json& object : json.at("objects"))
      phase.objects.push_back(
          {object.at("object").get<std::string>(), digest_from(object.at("digest"))});
  if (json.contains("fields"))
    for (const Json& field : json.at("fields"))
      phase.fields.push_back({field.at("object").get<std::string>(),
                              field.at("field").get<std::string>(),
                              field.at("value").get<std::string>()});
  return phase;
}

std::optional<TickTrace> trace_from_json(const Json& json) {
  try {
    TickTrace trace;
    trace.digest = digest_from(json.at("digest"));
    trace.fault = json.at("fault").get<std::string>();
    for (const Json& phase : json.at("phases")) trace.phases.push_back(phase_from(phase));
    return trace;
  } catch (const Json::exception&) {  // A member is missing, or is not what it should be.
    return std::nullopt;
  } catch (const Failure&) {
    return std::nullopt;
  }
}

}  // namespace cycloid::cli
