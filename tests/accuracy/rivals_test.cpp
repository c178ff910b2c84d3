#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/rivals/records.hpp"
#include "bench/rivals/table.hpp"
#include "scenes/build.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::rivals {
namespace {

using accuracy::ChartPlan;
using accuracy::ChartPoint;
using accuracy::SceneChart;
using testing::ElementsAre;
using testing::HasSubstr;
using Json = nlohmann::json;

SceneChart chart_of_trial(const char* name) {
  SceneChart chart;
  for (const scenes::Trial& trial : scenes::trials())
    if (trial.name == std::string(name)) chart.trial = trial;
  chart.subject = {chart.trial->make(), chart.trial->ticks, trials::judge_of(*chart.trial).act};
  chart.name = name;
  return chart;
}

/// A folder that goes with the test.
class Folder {
 public:
  Folder() : path_(testing::TempDir() + "rivals." + std::to_string(::getpid())) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string file(const std::string& name) const { return path_ + '/' + name; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

void write(const std::string& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

Json read_json(const std::string& file) {
  std::ifstream stream(file);
  return Json::parse(stream);
}

/// What record.mjs writes of a body.
template <int D>
void append_motion(const solver::BodyView<D>& body, std::string& bytes) {
  float numbers[13] = {};
  for (int i = 0; i < D; ++i) {
    numbers[i] = body.position[i];
    numbers[7 + i] = body.velocity[i];
  }
  if constexpr (solver::Dim<D>::kSpin == 1) {
    // Of half the angle, by a root alone, which rounds alike everywhere. @pre not half a turn.
    numbers[6] = std::sqrt(0.5f * (1.0f + body.rotation[0]));
    numbers[5] = 0.5f * body.rotation[1] / numbers[6];
    numbers[12] = body.spin[0];
  } else {
    for (int i = 0; i < 4; ++i) numbers[3 + i] = body.rotation[i];
    for (int i = 0; i < 3; ++i) numbers[10 + i] = body.spin[i];
  }
  bytes.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
}

/// The scene, run by our solver, as a record of somebody else.
template <int D>
std::string record_of(const SceneChart& chart, const accuracy::Setting& setting) {
  scenes::Scene scene = with_setting(chart.subject.scene, setting);
  scene.tuning.sleep_s = 0.0f;
  std::vector<scenes::Mistake> mistakes;
  const auto built = scenes::build<D>(scene, mistakes);
  std::string bytes;
  for (std::uint32_t tick = 0; tick < chart.subject.ticks; ++tick) {
    EXPECT_TRUE(built->world.step().ok());
    for (const solver::BodyView<D>& body : built->world.bodies()) append_motion(body, bytes);
  }
  return bytes;
}

/// Exports a run of our pgs 4x1, and makes its record and its result.
template <int D>
void record_one(const SceneChart& chart, const Folder& folder) {
  const accuracy::Setting pgs{"pgs", 4, 1, 0};
  export_runs({chart}, {{pgs}, {}}, folder.path());
  write(folder.file("0.bin"), record_of<D>(chart, pgs));
  write(folder.file("results.json"),
        R"([{"times_ns": [5000, 7000, 6000], "digest": "00000000000000ff"}])");
}

ChartPlan plan_beside(SceneChart chart, const Folder& folder,
                      std::vector<accuracy::Setting> ours = {{"pgs", 4, 1, 0}}) {
  ChartPlan plan;
  plan.scenes.push_back(std::move(chart));
  plan.settings = std::move(ours);
  plan.contenders = recorded_contenders(folder.path());
  plan.repeats = 3;
  run_chart(plan, [](const accuracy::ChartProgress&) {});
  return plan;
}

/// A rival that does what we do is measured as we are.
template <int D>
void expect_alike(const char* trial) {
  const Folder folder;
  record_one<D>(chart_of_trial(trial), folder);
  const ChartPlan plan = plan_beside(chart_of_trial(trial), folder);
  ASSERT_EQ(plan.scenes[0].points.size(), 2u);
  const ChartPoint& ours = plan.scenes[0].points[0];
  const ChartPoint& rival = plan.scenes[0].points[1];
  const accuracy::Metrics& a = ours.measured.metrics;
  const accuracy::Metrics& b = rival.measured.metrics;
  EXPECT_NEAR(a.penetration_steady_m->p95, b.penetration_steady_m->p95, 2e-6);
  EXPECT_NEAR(a.penetration_transient_m->max, b.penetration_transient_m->max, 2e-6);
  EXPECT_NEAR(*a.energy_gained_j, *b.energy_gained_j, 1e-3);
  EXPECT_NEAR(*a.jitter_m_s, *b.jitter_m_s, 1e-5);
  EXPECT_NEAR(*a.moved_m, *b.moved_m, 1e-5);
  EXPECT_EQ(ours.outcome->verdict, rival.outcome->verdict);
  EXPECT_NEAR(ours.outcome->value, rival.outcome->value, 1e-4);
  EXPECT_FALSE(b.natural_map) << "nobody knows its impulses";
  EXPECT_EQ(rival.measured.digest, 0xffu);
  EXPECT_THAT(rival.times, ElementsAre(5000, 7000, 6000));
  EXPECT_EQ(rival.measured.price.ns_per_tick, 6000.0);
  EXPECT_EQ(rival.contender, 0);
}

TEST(Rivals, OfThePlaneAreMeasuredAsWeAre) {
  expect_alike<2>("trial-heavy-on-light-10");
}
TEST(Rivals, OfSpaceAreMeasuredAsWeAre) {
  expect_alike<3>("trial-duplicate-points");
}

TEST(Rivals, WhoseRecordEndsEarlyHaveFailed) {
  const Folder folder;
  const SceneChart chart = chart_of_trial("trial-heavy-on-light-10");
  record_one<2>(chart, folder);
  const std::size_t tick_bytes = chart.subject.scene.bodies.size() * 52;
  std::filesystem::resize_file(folder.file("0.bin"), 100 * tick_bytes);
  const ChartPlan plan = plan_beside(chart, folder, {});
  EXPECT_FALSE(plan.scenes[0].points[0].measured.ended);
  EXPECT_TRUE(plan.scenes[0].points[0].failed);
  EXPECT_THAT(outcome_table(plan), HasSubstr("| x - |"));
}

TEST(Rivals, OfAnotherSceneAreRefused) {
  const Folder folder;
  record_one<2>(chart_of_trial("trial-heavy-on-light-10"), folder);
  std::filesystem::resize_file(folder.file("0.bin"), 1000);
  EXPECT_THROW(plan_beside(chart_of_trial("trial-heavy-on-light-10"), folder), std::runtime_error);
  write(folder.file("results.json"), "[]");
  EXPECT_THROW(recorded_contenders(folder.path()), std::runtime_error);
  write(folder.file("results.json"), "nothing");
  EXPECT_THROW(recorded_contenders(folder.path()), std::runtime_error);
}

TEST(Rivals, WhoCannotHoldASceneHaveNoPlaceInIt) {
  const Folder folder;
  record_one<2>(chart_of_trial("trial-heavy-on-light-10"), folder);
  write(folder.file("results.json"), R"([{"times_ns": [], "why_not": "no polygons"}])");
  EXPECT_TRUE(recorded_contenders(folder.path()).empty());
}

TEST(Rivals, AreExportedWithEverySettingOfTheirDimension) {
  const Folder folder;
  export_runs({chart_of_trial("trial-stack-10"), chart_of_trial("trial-duplicate-points"),
               chart_of_trial("trial-rush")},
              {{{"pgs", 4, 1, 0}, {"soft-step", 4, 1, 1}}, {2, 8}}, folder.path());
  const Json runs = read_json(folder.file("runs.json"));
  std::vector<std::string> said;
  for (const Json& run : runs)
    said.push_back(run.at("scene").get<std::string>().substr(6, 5) + ' ' +
                   run.at("engine").get<std::string>() + ' ' + run.at("substeps").dump());
  EXPECT_THAT(said,
              ElementsAre("stack ours 4", "stack ours 4", "stack Box2D v3 2", "stack Box2D v3 8",
                          "stack Box2D v3, 60 Hz 2", "stack Box2D v3, 60 Hz 8", "stack Rapier 2D 2",
                          "stack Rapier 2D 8", "dupli ours 4", "dupli ours 4", "dupli Rapier 3D 2",
                          "dupli Rapier 3D 8", "dupli Jolt 2", "dupli Jolt 8"))
      << "in trial-rush something happens besides what the scene says";
  std::ifstream stream(folder.file(runs[0].at("file")));
  const std::string text((std::istreambuf_iterator<char>(stream)), {});
  const scenes::Loaded loaded = scenes::from_json(text);
  ASSERT_TRUE(loaded.scene);
  EXPECT_EQ(loaded.scene->tuning.sleep_s, 0.0f);
  EXPECT_EQ(loaded.scene->tuning.stabilisation, solver::Stabilisation::kBaumgarte);
}

}  // namespace
}  // namespace cycloid::rivals
