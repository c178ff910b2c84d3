#include "server/host/host.hpp"

#include <unistd.h>

#include <csignal>
#include <utility>

#include "server/host/patient_log.hpp"
#include "server/host/process_time.hpp"
#include "server/host/realtime.hpp"

namespace cycloid::server {

Host::Host(HostOptions options)
    : options_(std::move(options)),
      io_(options_.threads),
      accept_strand_(asio::make_strand(io_)),
      signals_(accept_strand_),
      epoch_ns_(process_now_ns()),
      drain_ms_(options_.drain.count()),
      limits_(options_.limits) {
  // Lines that nobody reads any more end no match.
  if (options_.catch_signals) std::signal(SIGPIPE, SIG_IGN);
  // One line for each event that matters, on stderr: stdout belongs to the program's report.
  if (options_.logger == nullptr) options_.logger = log_to(STDERR_FILENO);
  const auto trouble = [this](const std::string& why) {
    options_.logger->warn("cannot accept connections: {}; trying again, said once", why);
  };
  const auto crowded = [this](asio::ip::tcp::socket& socket) {
    gatehouse_->turn_away_now(socket, {protocol::Refusal::kRoomFull,
                                       "the server has no descriptors for more connections"});
  };
  ListenerOptions listener{options_.address,
                           options_.port,
                           [this](asio::ip::tcp::socket s) { gatehouse_->receive(std::move(s)); },
                           crowded,
                           trouble,
                           [this] { meters_->accept_failures.add(); }};
  listener_.emplace(accept_strand_, std::move(listener));
  GatehouseOptions gatehouse;
  gatehouse.gate = options_.gate;
  gatehouse.sockets = options_.sockets;
  gatehouse.tls = options_.tls;
  gatehouse.logger = options_.logger;
  gatehouse.find_room = [this](const std::string& room, const Admission& admission) {
    return judge(room, admission);
  };
  gatehouse.on_admitted = [this](Entrant entrant) { on_admitted(std::move(entrant)); };
  gatehouse_.emplace(accept_strand_, meters_, std::move(gatehouse));
  options_.disk = metered(std::move(options_.disk), meters_);
  if (!options_.desync_directory.empty()) {
    ReportSinkOptions reports;
    reports.folder = options_.desync_directory;
    reports.now_ns = process_now_ns;
    reports_ = std::make_shared<ReportSink>(std::move(reports));
  }
  start_rooms();
}

Host::~Host() {
  slow_.join();
}

RoomSite Host::site() {
  const auto turn_away = [this](Entrant entrant, const protocol::Refused& refused) {
    auto shared = std::make_shared<Entrant>(std::move(entrant));
    asio::post(accept_strand_,
               [this, shared, refused] { gatehouse_->turn_away(std::move(*shared), refused); });
  };
  const auto gone_handler = [this](const std::string& name, const ServeReport& report) {
    gone(name, report);
  };
  return RoomSite{io_,      slow_,          meters_,   options_.logger, options_.disk,
                  reports_, step_memories_, epoch_ns_, turn_away,       gone_handler};
}

void Host::start_rooms() {
  for (NamedRoom& room : options_.rooms) {
    room.settings.limits = limits_.room;
    const auto slot = static_cast<std::uint32_t>(directory_.size());
    auto made = std::make_shared<HostedRoom>(site(), room.name, std::move(room.settings), slot);
    slots_.insert(slot);
    meters_->rooms_made.add();
    directory_.emplace(room.name, made);
  }
  options_.rooms.clear();
  for (const auto& [name, room] : directory_) room->start();
}

HostReport Host::run(std::stop_token stop) {
  if (options_.catch_signals) {
    signals_.add(SIGINT);
    signals_.add(SIGTERM);
    if (options_.on_reload) signals_.add(SIGHUP);
    wait_for_signal();
  }
  options_.logger->info("listening at {} port {}", options_.address, port());
  if (options_.tls != nullptr) {
    options_.logger->info("TLS only, certificate {} until Unix second {}",
                          options_.tls->fingerprint(), options_.tls->expires_unix_s());
  }
  listener_->start();
  {
    const std::stop_callback on_stop(stop, [this] { end("told to stop"); });
    run_pool();
  }
  slow_.join();
  over_.request_stop();
  if (thrown_) std::rethrow_exception(thrown_);
  const std::lock_guard lock(directory_mutex_);
  for (const Meter& refusals : meters_->refusals) report_.refusals += refusals.get();
  report_.gate_bytes = meters_->gate_bytes.get();
  return report_;
}

void Host::run_pool() {
  if (options_.realtime) {
    if (const std::string why = lock_memory(); !why.empty()) {
      options_.logger->warn("real time: {}; going on without", why);
    }
  }
  std::vector<std::thread> threads;
  for (int i = 1; i < options_.threads; ++i) threads.emplace_back([this] { run_thread(); });
  run_thread();
  for (std::thread& thread : threads) thread.join();
}

void Host::run_thread() {
  if (options_.realtime) {
    const std::string why = make_thread_realtime();
    static std::atomic<bool> said{false};
    if (!why.empty() && !said.exchange(true)) {
      options_.logger->warn("real time: {}; going on without", why);
    }
  }
  try {
    io_.run();
  } catch (...) {  // No room goes on beside one that broke its own rules.
    const std::lock_guard lock(thrown_mutex_);
    if (!thrown_) thrown_ = std::current_exception();
    io_.stop();
  }
}

void Host::wait_for_signal() {
  signals_.async_wait([this](const asio::error_code& error, int signal) {
    if (error) return;
    wait_for_signal();
    // It reads files, for which no room waits.
    if (signal == SIGHUP) return asio::post(slow_, options_.on_reload);
    const std::string name = signal == SIGINT ? "SIGINT" : "SIGTERM";
    if (++signals_heard_ == 1)
      return drain_time().count() > 0 ? drain(name, drain_time()) : end(name);
    for (const auto& room : rooms()) room->hurry(name);  // Asked twice: at once.
    asio::error_code ignored;
    signals_.clear(ignored);  // Asked thrice, such as while a disk hangs: as the system does it.
  });
}

std::shared_ptr<HostedRoom> Host::find(const std::string& name) const {
  const std::lock_guard lock(directory_mutex_);
  const auto found = directory_.find(name);
  return found == directory_.end() ? nullptr : found->second;
}

std::vector<std::shared_ptr<HostedRoom>> Host::rooms() const {
  const std::lock_guard lock(directory_mutex_);
  std::vector<std::shared_ptr<HostedRoom>> all;
  for (const auto& [name, room] : directory_) {
    if (room != nullptr) all.push_back(room);
  }
  return all;
}

void Host::drain(const std::string& reason, std::chrono::milliseconds deadline) {
  asio::post(accept_strand_, [this, reason, deadline] {
    const std::int64_t at_ns = process_now_ns() + std::chrono::nanoseconds(deadline).count();
    if (draining_.exchange(true) && at_ns >= drain_at_ns_) return;
    drain_at_ns_ = at_ns;
    options_.logger->info("draining: {}; rooms end within {} ms", reason, deadline.count());
    gatehouse_->drain("the server goes away: " + reason);
    for (const auto& room : rooms()) {
      room->act(LifeAct::kDrain, reason, deadline, {});
      room->hasten_drain(reason, deadline);  // One that drains already refuses the act.
    }
    finish_if_over();
  });
}

void Host::end(const std::string& reason) {
  asio::post(accept_strand_, [this, reason] {
    draining_ = true;
    drain_at_ns_ = 0;
    gatehouse_->drain("the server goes away: " + reason);
    for (const auto& room : rooms()) {
      room->act(LifeAct::kEnd, reason, std::chrono::milliseconds(0), {});
    }
    finish_if_over();
  });
}

std::string Host::stuck(std::uint32_t ticks_max) const {
  for (const auto& room : rooms()) {
    const RoomMeters& meters = room->meters();
    const std::int64_t armed_ns = meters.armed_ns;
    const std::int64_t late_ns = process_now_ns() - armed_ns;
    if (armed_ns == 0 || late_ns <= meters.tick_ns * static_cast<std::int64_t>(ticks_max)) continue;
    return "room " + room->name() + " is " + std::to_string(late_ns / 1'000'000) +
           " ms late for tick " + std::to_string(meters.tick.get() + 1);
  }
  return "";
}

void Host::set_limits(const HostLimits& limits) {
  {
    const std::lock_guard lock(directory_mutex_);
    limits_ = limits;
  }
  for (const auto& room : rooms()) room->set_limits(limits.room);
}

void Host::set_gate_limits(const GateOptions& gate) {
  asio::post(accept_strand_, [this, gate] { gatehouse_->set_limits(gate); });
}

void Host::set_token_keys(std::vector<PublicKey> keys) {
  asio::post(accept_strand_,
             [this, keys = std::move(keys)]() mutable { gatehouse_->set_keys(std::move(keys)); });
}

void Host::gone(const std::string& name, const ServeReport& report) {
  options_.logger->info("room {} is gone: {} at tick {}: {}", name, end_name(report.end),
                        report.ticks, report.reason);
  meters_->rooms_ended.add();
  asio::post(accept_strand_, [this, name, report] {
    {
      const std::lock_guard lock(directory_mutex_);
      const auto found = directory_.find(name);
      slots_.erase(found->second->slot());
      directory_.erase(found);
      constexpr std::size_t kReportsKept = 1024;
      if (report_.rooms.size() < kReportsKept || report_.rooms.contains(name)) {
        report_.rooms[name] = report;
      }
      ++report_.rooms_ended;
      report_.good = report_.good && report.good() && report.durable;
    }
    finish_if_over();
  });
}

void Host::finish_if_over() {
  {
    const std::lock_guard lock(directory_mutex_);
    if (!directory_.empty()) return;
  }
  if (!draining_ && !options_.ends_with_last_room) return;
  draining_ = true;
  listener_->close();
  gatehouse_->close();
  signals_.cancel();
}

}  // namespace cycloid::server
