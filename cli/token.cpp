#include "server/admission/token.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <iostream>
#include <limits>
#include <memory>

#include "cli/commands.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {
namespace {

using server::AdmissionToken;
using server::PublicKey;
using server::Role;
using server::SigningKey;

const std::vector<std::pair<std::string, Role>> kRoles = {
    {"player", Role::kPlayer}, {"spectator", Role::kSpectator}, {"admin", Role::kAdmin}};

/// So that a lifetime fits behind it.
constexpr std::int64_t kNotBeforeMax_unix_s =
    std::numeric_limits<std::int64_t>::max() - server::kTokenLifetimeMax_s;

std::string role_name(Role role) {
  for (const auto& [name, each] : kRoles) {
    if (each == role) return name;
  }
  return "unknown";
}

Role role_of(const std::string& name) {
  for (const auto& [each, role] : kRoles) {
    if (each == name) return role;
  }
  throw Failure(kExitUsage, "--role: " + name + " is none of player, spectator, admin");
}

std::int64_t now_unix_s() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::seconds>(now).count();
}

/// A new file; what exists is never overwritten, because a key that is lost is lost.
void create_file(const std::string& file, const std::string& text, unsigned mode) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (descriptor < 0) {
    const std::string why = errno == EEXIST
                                ? "exists already, and a key is never overwritten"
                                : std::string("cannot be created: ") + std::strerror(errno);
    throw Failure(kExitIo, file + ": " + why);
  }
  const bool written =
      ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      ::fsync(descriptor) == 0;
  const bool closed = ::close(descriptor) == 0;
  if (written && closed) return;
  const std::string why = std::strerror(errno);
  ::unlink(file.c_str());
  throw Failure(kExitIo, file + ": cannot be written: " + why);
}

std::string key_text(const std::string& file) {
  const std::vector<std::byte> bytes = read_file(file);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

SigningKey read_signing_key(const std::string& file) {
  const auto key = SigningKey::parse(key_text(file));
  if (!key)
    throw Failure(kExitCorrupt, file + ": is no signing key, as 'cycloid token keygen' writes one");
  struct stat status {};
  if (::stat(file.c_str(), &status) == 0 && (status.st_mode & 077) != 0) {
    throw Failure(kExitIo, file +
                               ": others than its owner may read it, and then sign as you; "
                               "chmod 600 it, or make a new one");
  }
  return *key;
}

PublicKey read_public_key(const std::string& file) {
  const auto key = PublicKey::parse(key_text(file));
  if (!key)
    throw Failure(kExitCorrupt, file + ": is no public key, as 'cycloid token keygen' writes one");
  return *key;
}

void print_text(const Json& object) {
  for (const auto& [name, value] : object.items()) {
    print_member(name, value);
  }
}

Exit publish(const Json& object, Exit exit, bool json) {
  if (json) print_json(object, exit);
  if (!json) print_text(object);
  return exit;
}

Exit make_key(const std::string& file, bool json) {
  const std::string public_file = file + ".pub";
  const SigningKey key = SigningKey::generate(server::system_random());
  create_file(file, key.text() + "\n", 0600);
  try {
    create_file(public_file, key.public_key().text() + "\n", 0644);
  } catch (const Failure&) {  // Half a pair is none.
    ::unlink(file.c_str());
    throw;
  }
  return publish({{"key", file},
                  {"public_key", public_file},
                  {"id", hex16(key.public_key().id())},
                  {"public", key.public_key().text()}},
                 kExitGood, json);
}

struct MakeToken {
  std::string key;
  AdmissionToken token;
  std::string role = "player";
  std::int64_t lifetime_s = 60;
};

Json to_json(const AdmissionToken& token) {
  Json nonce = "";
  for (const std::byte byte : token.nonce)
    nonce.get_ref<std::string&>() += hex16(static_cast<std::uint64_t>(byte)).substr(14);
  return {{"room", token.room},
          {"seat", token.seat == protocol::kAnySeat ? Json("any") : Json(token.seat)},
          {"role", role_name(token.role)},
          {"identity", token.identity},
          {"not_before", token.not_before_unix_s},
          {"expires", token.expires_unix_s},
          {"nonce", nonce}};
}

Exit make_token(MakeToken wish, bool json) {
  AdmissionToken& token = wish.token;
  token.role = role_of(wish.role);
  if (token.not_before_unix_s == 0) token.not_before_unix_s = now_unix_s();
  token.expires_unix_s = token.not_before_unix_s + wish.lifetime_s;
  if (const std::string mistake = server::mistake_of(token); !mistake.empty())
    throw Failure(kExitUsage, mistake);
  const SigningKey key = read_signing_key(wish.key);
  std::string text;
  do {  // A token that begins with '-' would be taken for an option wherever it is pasted.
    server::system_random()(token.nonce);
    text = server::token_text(server::sign_token(token, key));
  } while (text[0] == '-');
  if (!json) {
    std::cout << text << '\n';
    return kExitGood;
  }
  Json object = {{"token", text}, {"key", hex16(key.public_key().id())}};
  object.update(to_json(token));
  print_json(object, kExitGood);
  return kExitGood;
}

Exit show_token(const std::string& text, const std::vector<std::string>& key_files, bool json) {
  std::vector<PublicKey> keys;
  for (const std::string& file : key_files) keys.push_back(read_public_key(file));
  const auto bytes = server::parse_token_text(text);
  if (!bytes) throw Failure(kExitCorrupt, "TOKEN: is no base64url of at most 512 bytes");
  const auto read = server::read_unverified(*bytes);
  if (const auto* fault = std::get_if<server::TokenFault>(&read))
    throw Failure(kExitCorrupt, "TOKEN: " + fault->reason);
  const auto& unverified = std::get<server::UnverifiedToken>(read);
  Json object = to_json(unverified.token);
  object["key"] = hex16(unverified.key_id);
  object["bytes"] = bytes->size();
  if (keys.empty()) {
    object["verdict"] = "not verified, because no --key was given";
    return publish(object, kExitGood, json);
  }
  const auto verified = server::TokenVerifier(keys).verify(*bytes, now_unix_s());
  const auto* fault = std::get_if<server::TokenFault>(&verified);
  object["verdict"] = fault == nullptr ? "good" : fault->reason;
  return publish(object, fault == nullptr ? kExitGood : kExitCorrupt, json);
}

void add_make(CLI::App& token, Action& action) {
  auto wish = std::make_shared<MakeToken>();
  CLI::App* make = add_command(token, "make", "Sign a token that lets its bearer in once", action);
  make->add_option("--key", wish->key, "The signing key")->required();
  make->add_option("--room", wish->token.room, "The room, 1 to 64 bytes")->required();
  make->add_option("--seat", wish->token.seat, "This seat only; -1: any")
      ->capture_default_str()
      ->check(CLI::Range(-1, 255));
  make->add_option("--role", wish->role, "player, spectator or admin")->capture_default_str();
  make->add_option("--identity", wish->token.identity, "Who it is, for logs; at most 64 bytes");
  make->add_option("--lifetime", wish->lifetime_s, "Seconds that it is good for")
      ->capture_default_str()
      ->check(CLI::Range(std::int64_t{1}, server::kTokenLifetimeMax_s));
  make->add_option("--not-before", wish->token.not_before_unix_s,
                   "Unix seconds from which it is good [now]")
      ->check(CLI::Range(std::int64_t{0}, kNotBeforeMax_unix_s));
  make->callback(
      [wish, &action] { action.run = [=, &action] { return make_token(*wish, action.json); }; });
}

}  // namespace

void add_token(CLI::App& app, Action& action) {
  CLI::App* token = app.add_subcommand("token", "Make keys and tokens that let players in");
  token->footer(kExitCodesText);
  token->require_subcommand(1);

  auto file = std::make_shared<std::string>();
  CLI::App* keygen = add_command(
      *token, "keygen", "Write a signing key to FILE (mode 0600) and its public half to FILE.pub",
      action);
  keygen->add_option("FILE", *file, "Both must be new")->required();
  keygen->callback(
      [file, &action] { action.run = [=, &action] { return make_key(*file, action.json); }; });

  add_make(*token, action);

  auto text = std::make_shared<std::string>();
  auto keys = std::make_shared<std::vector<std::string>>();
  CLI::App* show = add_command(*token, "show",
                               "What a token says; with --key whether a server takes it now, and "
                               "exit 3 where not",
                               action);
  show->add_option("TOKEN", *text, "As 'make' writes it")->required();
  show->add_option("--key", *keys, "Public keys of the server; may be repeated");
  show->callback([text, keys, &action] {
    action.run = [=, &action] { return show_token(*text, *keys, action.json); };
  });
}

}  // namespace cycloid::cli
