#include "bench/rivals/records.hpp"

#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "scenes/build.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::rivals {
namespace {

using accuracy::ChartPoint;
using accuracy::Contender;
using accuracy::MeasureOptions;
using accuracy::SceneChart;
using accuracy::Setting;
using Json = nlohmann::json;

/// Of a body at a tick: position, quaternion, velocity, spin; position and turn of its frame.
constexpr std::size_t kNumbers = 13;

/// The engines of bench/peers/node beside ours, and what they are.
struct NodeEngine {
  const char* name;
  std::uint32_t dimension;
  std::uint32_t sweeps;  ///< In each of their substeps; Jolt's are of velocities.
  std::uint32_t relax_sweeps;
};
constexpr NodeEngine kNodeEngines[] = {{"Box2D v3", 2, 1, 1},
                                       {"Box2D v3, 60 Hz", 2, 1, 1},
                                       {"Rapier 2D", 2, 1, 0},
                                       {"Rapier 3D", 3, 1, 0},
                                       {"Jolt", 3, 10, 0}};

void write_text(const std::string& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text << std::flush;
  if (!stream) throw std::runtime_error(file + ": cannot be written");
}

std::string read_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw std::runtime_error(file + ": cannot be read");
  return text.str();
}

Json read_json(const std::string& file) {
  const Json json = Json::parse(read_text(file), nullptr, false);
  if (!json.is_array()) throw std::runtime_error(file + ": is no list");
  return json;
}

/// The runs of the folder, as they are exported.
class Exporter {
 public:
  explicit Exporter(const std::string& folder) : folder_(folder) {}

  void add(const SceneChart& chart, const scenes::Scene& scene, const std::string& engine,
           const Setting& setting) {
    const std::string number = std::to_string(runs_.size());
    write_text(folder_ + '/' + number + ".json", scenes::to_json(scene));
    runs_.push_back({{"engine", engine},
                     {"scene", chart.name},
                     {"file", number + ".json"},
                     {"record", number + ".bin"},
                     {"ticks", chart.subject.ticks},
                     {"method", setting.method},
                     {"substeps", setting.substeps},
                     {"sweeps", setting.sweeps},
                     {"relax_sweeps", setting.relax_sweeps}});
  }
  void finish() const { write_text(folder_ + "/runs.json", runs_.dump(1) + '\n'); }

 private:
  std::string folder_;
  Json runs_ = Json::array();
};

/// What record.mjs has made of a run.
struct Record {
  std::string scene;
  Setting setting;
  std::string file;
  std::uint32_t ticks = 0;
  std::vector<double> times_ns;  ///< Of a tick, by round.
  std::uint64_t digest = 0;
};

template <int D>
class RecordedRun final : public RivalRun<D> {
 public:
  RecordedRun(const solver::WorldState<D>& start, const Record& record)
      : state_(without_contacts(start)), bytes_(read_text(record.file)) {
    const std::size_t tick_bytes = state_.bodies.size() * kNumbers * sizeof(float);
    if (bytes_.size() > tick_bytes * record.ticks || bytes_.size() % tick_bytes != 0)
      throw std::runtime_error(record.file + ": is not of as many bodies and ticks as the scene");
  }

  bool step(std::uint32_t tick) override {
    const std::size_t tick_bytes = state_.bodies.size() * kNumbers * sizeof(float);
    if (bytes_.size() < tick_bytes * tick) return false;
    for (std::size_t i = 0; i < state_.bodies.size(); ++i) {
      float numbers[kNumbers];
      std::memcpy(numbers, bytes_.data() + tick_bytes * (tick - 1) + i * sizeof numbers,
                  sizeof numbers);
      take(numbers, state_.bodies[i].local_center, state_.bodies.moved(i));
    }
    return true;
  }
  const solver::WorldState<D>& state() const override { return state_; }

 private:
  static void take(const float (&from)[kNumbers], const solver::Vec<D>& centre,
                   solver::BodyMotion<D>& body) {
    if constexpr (solver::Dim<D>::kRotation == 2)
      body.rotation = {{from[6] * from[6] - from[5] * from[5], 2.0f * from[5] * from[6]}};
    else
      body.rotation = {{from[3], from[4], from[5], from[6]}};
    for (int i = 0; i < D; ++i) {
      body.position[i] = from[i];
      body.velocity[i] = from[7 + i];
    }
    body.position += rotate(body.rotation, centre);
    for (int i = 0; i < solver::Dim<D>::kSpin; ++i)
      body.spin[i] = from[10 + (solver::Dim<D>::kSpin == 1 ? 2 : i)];
  }

  solver::WorldState<D> state_;
  std::string bytes_;
};

template <int D>
std::optional<ChartPoint> measure_record(const SceneChart& chart, const Record& record,
                                         const MeasureOptions& options) {
  std::vector<scenes::Mistake> mistakes;
  const auto built = scenes::build<D>(chart.subject.scene, mistakes);
  if (built == nullptr) return {};
  RecordedRun<D> run(built->world.state(), record);
  ChartPoint point = measure_rival(chart, run, record.setting, options);
  point.measured.digest = record.digest;
  return point;
}

/// A setting's records, of every scene in which it was run.
Contender contender_of(const Setting& setting, const std::vector<Record>& records) {
  const auto record_of = [records](const SceneChart& chart) -> const Record* {
    for (const Record& record : records)
      if (record.scene == chart.name) return &record;
    return nullptr;
  };
  return {setting,
          [=](const SceneChart& chart, const MeasureOptions& options) -> std::optional<ChartPoint> {
            const Record* record = record_of(chart);
            if (record == nullptr) return {};
            if (chart.subject.scene.dimension == 3)
              return measure_record<3>(chart, *record, options);
            return measure_record<2>(chart, *record, options);
          },
          [=](const SceneChart& chart, std::uint32_t round) {
            const std::vector<double>& times = record_of(chart)->times_ns;
            return times[round % times.size()];
          }};
}

Record read_record(const Json& run, const Json& result, const std::string& folder) {
  Record record;
  record.scene = run.at("scene");
  record.setting = {run.at("method"), run.at("substeps"), run.at("sweeps"), run.at("relax_sweeps")};
  record.file = folder + '/' + run.at("record").get<std::string>();
  record.ticks = run.at("ticks");
  record.times_ns = result.at("times_ns").get<std::vector<double>>();
  if (const std::string digest = result.value("digest", ""); !digest.empty())
    record.digest = std::stoull(digest, nullptr, 16);
  if (record.times_ns.empty()) throw std::runtime_error(record.file + ": was not timed");
  return record;
}

}  // namespace

void export_runs(const std::vector<SceneChart>& charts, const RecordedSettings& settings,
                 const std::string& folder) {
  Exporter exporter(folder);
  for (const SceneChart& chart : charts) {
    scenes::Scene scene = chart.subject.scene;
    if (!scene.seats.empty() || chart.subject.act != nullptr) continue;
    scene.tuning.sleep_s = 0.0f;
    for (const Setting& setting : settings.ours) {
      scenes::Scene ours = with_setting(scene, setting);
      ours.tuning.sleep_s = 0.0f;
      exporter.add(chart, ours, "ours", setting);
    }
    for (const NodeEngine& engine : kNodeEngines)
      for (const std::uint32_t substeps : settings.substeps)
        if (engine.dimension == scene.dimension)
          exporter.add(chart, scene, engine.name,
                       {engine.name, substeps, engine.sweeps, engine.relax_sweeps});
  }
  exporter.finish();
}

std::vector<Contender> recorded_contenders(const std::string& folder) {
  const Json runs = read_json(folder + "/runs.json");
  const Json results = read_json(folder + "/results.json");
  if (runs.size() != results.size())
    throw std::runtime_error(folder + "/results.json: has not as many runs as runs.json");
  std::vector<std::pair<Setting, std::vector<Record>>> by_setting;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (results[i].contains("why_not")) continue;
    Record record = read_record(runs[i], results[i], folder);
    auto found = by_setting.begin();
    while (found != by_setting.end() && !(found->first == record.setting)) ++found;
    if (found == by_setting.end())
      found = by_setting.insert(found, {record.setting, std::vector<Record>()});
    found->second.push_back(std::move(record));
  }
  std::vector<Contender> contenders;
  for (const auto& [setting, records] : by_setting)
    contenders.push_back(contender_of(setting, records));
  return contenders;
}

}  // namespace cycloid::rivals
