#include "bench/load/join_age.hpp"

#include <fstream>
#include <memory>
#include <stdexcept>

#include "bench/load/load_client.hpp"
#include "bench/load/metrics_page.hpp"
#include "bench/load/places.hpp"
#include "bench/load/server_process.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::load {
namespace {

constexpr const char* kScene = "room:bodies=64";
constexpr int kTicksPerSecond = 2000;
constexpr int kJoins = 50;
constexpr std::chrono::milliseconds kBetweenJoins{40};
constexpr std::chrono::milliseconds kLook{100};
/// For as many ticks, so many times what they take where nothing is late.
constexpr int kPatience = 4;

void write_config(const std::filesystem::path& file, const std::filesystem::path& logs,
                  std::uint16_t operation_port) {
  std::filesystem::create_directory(logs);
  std::ofstream(file)
      << "[server]\nport = 0\ndrain_s = 0\nlog_level = \"error\"\n"
         "[limits]\nmessages_per_s = 100000\nbytes_per_s = 10000000\n[operation]\nport = "
      << operation_port << "\n[template.old]\nscene = \"" << kScene
      << "\"\ntick_rate_hz = " << kTicksPerSecond << "\nlog_directory = \"" << logs.string()
      << "\"\n[[room]]\nname = \"old\"\ntemplate = \"old\"\n";
}

/// The match, one who plays in it, and who joins it.
class Match {
 public:
  explicit Match(const std::string& program) : operation_port_(free_port()) {
    write_config(folder_ / "old.toml", folder_ / "logs", operation_port_);
    server_ = std::make_unique<ServerProcess>(
        program, std::vector<std::string>{"serve", "--config", (folder_ / "old.toml").string()});
    plan_.port = server_->port();
    plan_.room = "old";
    plan_.scene_digest = scenes::scene_digest(*scenes::find(kScene).scene);
    player_ = std::make_shared<LoadClient>(io_, plan_, player_tally_);
    player_->start();
    plan_.behaviour = Behaviour::kWatches;
  }
  ~Match() { player_->stop(); }
  Match(const Match&) = delete;
  Match& operator=(const Match&) = delete;

  std::uint64_t tick() const {
    return static_cast<std::uint64_t>(MetricsPage::fetch(operation_port_).sum("cycloid_room_tick"));
  }

  void grow_to(std::uint64_t tick) {
    const auto seconds = std::chrono::seconds(tick / kTicksPerSecond + 1);
    const auto end = Clock::now() + kPatience * seconds;
    while (this->tick() < tick) {
      if (Clock::now() > end) {
        throw std::runtime_error("joins: the match is at tick " + std::to_string(this->tick()) +
                                 ", not yet " + std::to_string(tick));
      }
      run_for(kLook);
    }
  }

  JoinAge join() {
    JoinAge result;
    result.tick = tick();
    result.joins = kJoins;
    ClientTally tally;
    for (int i = 0; i < kJoins; ++i) {
      const auto newcomer = std::make_shared<LoadClient>(io_, plan_, tally);
      newcomer->start();
      run_for(kBetweenJoins);
      newcomer->stop();
    }
    run_for(kLook);  // What is left of the stopped ones refers to the tally.
    if (tally.join_ms.size() != static_cast<std::size_t>(kJoins) || player_tally_.closed != 0) {
      throw std::runtime_error("joins: " + std::to_string(tally.join_ms.size()) + " of " +
                               std::to_string(kJoins) + " had their state at tick " +
                               std::to_string(result.tick) + "; " + tally.last_refusal);
    }
    result.p50_ms = tally.join_ms.quantile(500);
    result.max_ms = tally.join_ms.quantile(1000);
    result.resident_mb = static_cast<double>(server_->usage().resident_bytes) / 1e6;
    return result;
  }

 private:
  void run_for(std::chrono::milliseconds time) {
    io_.restart();
    io_.run_for(time);
  }

  OwnFolder folder_;
  std::uint16_t operation_port_;
  std::unique_ptr<ServerProcess> server_;
  asio::io_context io_{1};
  ClientPlan plan_;
  ClientTally player_tally_;
  std::shared_ptr<LoadClient> player_;
};

}  // namespace

std::vector<JoinAge> measure_joins(const std::string& program,
                                   const std::vector<std::uint64_t>& ages) {
  Match match(program);
  std::vector<JoinAge> all;
  for (const std::uint64_t age : ages) {
    match.grow_to(age);
    all.push_back(match.join());
  }
  return all;
}

}  // namespace cycloid::load
