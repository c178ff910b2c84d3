#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/catalogue.hpp"
#include "server/host/host.hpp"
#include "server/operation/operation.hpp"

namespace cycloid::server {

/// A server as a file describes it.
struct ServerConfig {
  HostOptions host;
  OperationOptions operation;
  bool operation_on = true;
  std::string log_level = "info";
  std::string admin_token_file;  ///< "": no admin interface.
  bool admin_remote = false;
  std::string snapshot_directory;
  std::string token_keys_file;  ///< Public keys, one in a line.
  bool tls_required = false;
  TlsFiles tls_files;
  /// Every key and its value as text, so that two files can be compared.
  std::map<std::string, std::string> values;
};

struct ConfigMistake {
  std::uint32_t line = 0;  ///< From 1; 0: of the file as a whole.
  std::string key;         ///< "server.port", or "".
  std::string reason;      ///< A sentence.
};

/// A configuration, or its mistakes: all of them, in the order of the file, unless it is no TOML,
/// which ends the search at the first.
struct ConfigResult {
  std::optional<ServerConfig> config;
  std::vector<ConfigMistake> mistakes;
};

using SceneLoader = std::function<scenes::Loaded(const std::string&)>;

/// Reads TOML. Opens no file but those that it names: scenes, by `load_scene`, the admin's token,
/// the keys of tokens, and the certificate.
ConfigResult read_config(std::string_view text, const SceneLoader& load_scene);
/// The same of a file; one that cannot be read is a mistake.
ConfigResult read_config_file(const std::string& path, const SceneLoader& load_scene);

/// "FILE:LINE: key: reason", one line per mistake, without the last newline.
std::string config_mistakes_text(const std::string& file,
                                 const std::vector<ConfigMistake>& mistakes);

/// The keys that differ and cannot be changed while a server runs; none: the change may be taken.
std::vector<std::string> fixed_differences(const ServerConfig& running, const ServerConfig& wanted);

/// What the documents say of a key.
struct ConfigKeyText {
  std::string name;   ///< "template.NAME.scene", "room.name".
  std::string range;  ///< "0 to 65535".
  std::string otherwise;
  bool reloads = false;
};
/// All keys that the reader knows.
std::vector<ConfigKeyText> config_keys();

}  // namespace cycloid::server
