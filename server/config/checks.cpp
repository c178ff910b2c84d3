#include "server/config/checks.hpp"

#include <algorithm>
#include <asio/ip/address.hpp>
#include <filesystem>
#include <set>
#include <sstream>
#include <utility>

#include "scenes/simulation.hpp"
#include "server/operation/text_file.hpp"

namespace cycloid::server {
namespace {

using Complain = std::function<void(const std::string&, std::string)>;

void check_address(const std::string& key, const std::string& text, const Complain& complain) {
  asio::error_code error;
  (void)asio::ip::make_address(text, error);
  if (error) complain(key, "\"" + text + "\" is no IP address");
}

void check_operation_address(const ServerConfig& config, const Complain& complain) {
  const std::string key = "operation.address";
  check_address(key, config.operation.address, complain);
  asio::error_code error;
  const auto address = asio::ip::make_address(config.operation.address, error);
  if (error || !address.is_v6() || !config.operation_on || HttpServer::knows_ipv6()) return;
  complain(key, "it is an IPv6 address, and the CivetWeb of this machine was built without IPv6");
}

void check_admin(ServerConfig& config, const Complain& complain) {
  const std::string& directory = config.snapshot_directory;
  std::error_code unknown;  // What may not be looked at is no directory for us.
  if (!directory.empty() && !std::filesystem::is_directory(directory, unknown)) {
    complain("admin.snapshot_directory", directory + " is no directory");
  }
  if (config.admin_token_file.empty()) return;
  AdminOptions admin;
  std::string mistake;
  admin.token = read_admin_token(config.admin_token_file, mistake);
  if (!mistake.empty()) complain("admin.token_file", mistake);
  admin.snapshot_directory = directory;
  config.operation.admin = std::move(admin);
  if (!config.operation_on) complain("admin.token_file", "operation.enabled is false");
  asio::error_code error;
  const auto address = asio::ip::make_address(config.operation.address, error);
  if (!error && !address.is_loopback() && !config.admin_remote) {
    complain("operation.address",
             "others could reach the admin interface there; where that is wanted, write "
             "admin.remote = true");
  }
}

void check_rooms(const ServerConfig& config, const Complain& complain) {
  for (const auto& [name, of] : config.host.templates) {
    if (!of.on_first_join || of.settings.empty_ttl.count() > 0) continue;
    complain("template." + name + ".empty_ttl_s",
             "with on_first_join anybody makes rooms, so they must end when they are empty");
  }
  const auto joins = [](const auto& named) { return named.second.on_first_join; };
  const bool made_later = std::ranges::any_of(config.host.templates, joins) ||
                          (config.operation.admin && !config.host.templates.empty());
  if (config.host.rooms.empty() && !made_later) {
    complain("room", "there is no room, and nothing that could make one");
  }
  if (config.host.rooms.size() > config.host.limits.rooms_max) {
    complain("limits.rooms", "the file has " + std::to_string(config.host.rooms.size()) + " rooms");
  }
}

/// What an exact state of the scene takes as the match begins, in bytes; 0 where it cannot.
std::uint64_t first_state_bytes(const scenes::Scene& scene) {
  const auto simulation = scenes::Simulation::create(scene);
  std::vector<std::byte> state;
  if (simulation.ok()) simulation.value().encode(state);
  return state.size();
}

/// A room keeps what its late spectators need; within the bounds, where that can be told before.
void check_delays(const ServerConfig& config, const Complain& complain) {
  const Limits& limits = config.host.limits.room;
  for (const auto& [name, of] : config.host.templates) {
    const std::uint64_t delay_ticks = of.settings.spectator_delay_ticks;
    if (delay_ticks == 0) continue;
    const std::string key = "template." + name + ".spectator_delay_ticks";
    const std::uint64_t frames = frames_for_delay(delay_ticks, limits.keyframe_ticks);
    if (frames > limits.frames_kept_max) {
      complain(key, "it and twice limits.keyframe_ticks are " + std::to_string(frames) +
                        " frames, of at most " + std::to_string(limits.frames_kept_max) +
                        " that limits.frames_kept allows");
      continue;
    }
    const std::uint64_t states = states_for_delay(delay_ticks, limits.keyframe_ticks);
    const std::uint64_t bytes = states * first_state_bytes(of.settings.scene);
    if (bytes <= limits.keyframe_bytes_max) continue;
    complain(key, "with limits.keyframe_ticks it needs " + std::to_string(states) +
                      " kept states, which take " + std::to_string(bytes) +
                      " bytes as the match begins, of at most " +
                      std::to_string(limits.keyframe_bytes_max) +
                      " that limits.keyframe_bytes allows");
  }
}

void check_tokens(ServerConfig& config, const Complain& complain) {
  const std::string key = "admission.keys_file";
  const std::string& file = config.token_keys_file;
  if (file.empty()) {
    const bool needed = config.host.gate.tokens != TokenPolicy::kIgnored;
    if (needed) complain(key, "it is missing: without keys no token is good");
    return;
  }
  const auto text = read_text_file(file);
  if (!text) return complain(key, file + ": cannot be read");
  std::istringstream stream(*text);
  std::string line;
  bool mistaken = false;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    const auto parsed = PublicKey::parse(line);
    if (parsed) config.host.gate.keys.push_back(*parsed);
    if (!parsed) {
      mistaken = true;
      complain(key, file + ":" + std::to_string(number) +
                        ": it is no public key: \"ed25519-public:\" and 64 hexadecimal digits");
    }
  }
  const bool none = !mistaken && config.host.gate.keys.empty();
  if (none) complain(key, file + ": there is no key in it");
}

void check_tls(ServerConfig& config, const Complain& complain) {
  if (!config.tls_required) return;
  if (config.tls_files.certificate_chain.empty()) complain("tls.certificate_file", "it is missing");
  if (config.tls_files.private_key.empty()) complain("tls.key_file", "it is missing");
  if (config.tls_files.certificate_chain.empty() || config.tls_files.private_key.empty()) return;
  try {
    config.host.tls = std::make_shared<ServerTls>(config.tls_files);
  } catch (const TlsFileError& error) {
    complain(error.of_key ? "tls.key_file" : "tls.certificate_file", error.what());
  }
}

}  // namespace

void check_config(ServerConfig& config, const Complain& complain) {
  check_address("server.address", config.host.address, complain);
  check_operation_address(config, complain);
  check_tokens(config, complain);
  check_tls(config, complain);
  check_admin(config, complain);
  check_rooms(config, complain);
  check_delays(config, complain);
}

std::string config_mistakes_text(const std::string& file,
                                 const std::vector<ConfigMistake>& mistakes) {
  std::string text;
  for (const ConfigMistake& mistake : mistakes) {
    if (!text.empty()) text += '\n';
    text += file;
    if (mistake.line > 0) text += ":" + std::to_string(mistake.line);
    text += ": " + (mistake.key.empty() ? "" : mistake.key + ": ") + mistake.reason;
  }
  return text;
}

std::vector<std::string> fixed_differences(const ServerConfig& running,
                                           const ServerConfig& wanted) {
  std::set<std::string> reloads;
  for (const ConfigKeyText& key : config_keys()) {
    if (key.reloads) reloads.insert(key.name);
  }
  std::set<std::string> fixed;
  for (const auto& [a, b] : {std::pair(&running, &wanted), std::pair(&wanted, &running)}) {
    for (const auto& [key, value] : a->values) {
      const auto other = b->values.find(key);
      const bool same = other != b->values.end() && other->second == value;
      if (!same && !reloads.contains(key)) fixed.insert(key);
    }
  }
  return {fixed.begin(), fixed.end()};
}

}  // namespace cycloid::server
