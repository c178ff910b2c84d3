#include "server/config/run.hpp"

#include <spdlog/logger.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

namespace cycloid::server {
namespace {

constexpr int kNotNow = 409;
constexpr int kMistaken = 422;

/// Reads the configuration again, and takes what may be taken from it: all or nothing.
class Reloader {
 public:
  explicit Reloader(ConfiguredServer& server) : server_(server) {}

  /// Any thread. The host must be there when it is called.
  ActResult reload(Host& host) {
    const ActResult result = try_to_take(host);
    if (result.ok()) host.logger()->info("reloaded {}", server_.file);
    if (!result.ok()) host.logger()->error("not reloaded, nothing is changed: {}", result.text);
    return result;
  }

 private:
  ActResult try_to_take(Host& host) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    // Not waited for: files that do not answer would take one thread beside the pool after another.
    if (!lock) return {kNotNow, "a reload is under way"};
    try {
      return take(host);
    } catch (const std::exception& error) {  // A mistake in a file ends no match.
      return {kMistaken, error.what()};
    }
  }

  ActResult take(Host& host) {
    ConfigResult read = read_config_file(server_.file, server_.load_scene);
    if (!read.config) return {kMistaken, config_mistakes_text(server_.file, read.mistakes)};
    ServerConfig& wanted = *read.config;
    std::string keys;
    for (const std::string& key : fixed_differences(server_.config, wanted)) {
      keys += (keys.empty() ? "" : ", ") + key;
    }
    if (!keys.empty()) return {kNotNow, "these cannot change while the server runs: " + keys};
    if (server_.override_config) server_.override_config(wanted);
    // The files were read without a mistake just now; they may still have gone since.
    const auto& tls = server_.config.host.tls;
    if (std::string why = tls == nullptr ? "" : tls->reload(); !why.empty()) {
      return {kMistaken, "tls: " + why};
    }
    if (tls != nullptr) {
      host.logger()->info("certificate {} until Unix second {}", tls->fingerprint(),
                          tls->expires_unix_s());
    }
    host.set_limits(wanted.host.limits);
    host.set_gate_limits(wanted.host.gate);
    host.set_token_keys(wanted.host.gate.keys);
    host.set_drain(wanted.host.drain);
    host.logger()->set_level(spdlog::level::from_str(wanted.log_level));
    server_.config.values = wanted.values;
    return {};
  }

  ConfiguredServer& server_;
  std::mutex mutex_;
};

}  // namespace

HostReport run_configured(ConfiguredServer server,
                          const std::function<void(const ListeningAt&)>& on_listening,
                          std::stop_token stop) {
  // Before the host, which begins logs.
  std::unique_ptr<HttpServer> http;
  if (server.config.operation_on) http = Operation::bind(server.config.operation);
  Reloader reloader(server);
  Host* running = nullptr;
  HostOptions options = server.config.host;
  if (!server.file.empty()) options.on_reload = [&] { (void)reloader.reload(*running); };
  Host host(std::move(options));
  running = &host;
  host.logger()->set_level(spdlog::level::from_str(server.config.log_level));
  OperationOptions operation = server.config.operation;
  if (operation.admin && !server.file.empty()) {
    operation.admin->reload = [&] { return reloader.reload(host); };
  }
  std::optional<Operation> watched;
  if (http != nullptr) watched.emplace(host, std::move(operation), std::move(http));
  if (on_listening) {
    on_listening({host.port(), watched ? watched->port() : std::uint16_t{0}});
  }
  return host.run(std::move(stop));
}

}  // namespace cycloid::server
