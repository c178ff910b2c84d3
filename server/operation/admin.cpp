#include "server/operation/admin.hpp"

#include <sodium.h>

#include <atomic>
#include <future>
#include <stop_token>
#include <utility>

#include "protocol/text.hpp"
#include "scenes/simulation.hpp"
#include "server/admission/constant_time.hpp"
#include "server/admission/random.hpp"
#include "server/operation/admin_fields.hpp"
#include "server/operation/text_file.hpp"

namespace cycloid::server {
namespace {

using Json = nlohmann::json;
using namespace std::chrono_literals;

constexpr std::uint64_t kDeadlineMsMax = 86'400'000;
constexpr std::uint64_t kTickMax = 1'000'000'000'000'000;
constexpr auto kStrangerInterval = 1s;

HttpReply reply_of(int status, const Json& body) {
  // What came from outside may be no UTF-8, and must not throw here.
  return {status, "application/json",
          body.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n", ""};
}

HttpReply reply_of(const ActResult& result) {
  if (!result.ok()) return reply_of(result.status, {{"error", result.text}});
  return reply_of(result.status, {{"done", true}});
}

HttpReply wrong_method(const std::string& allowed) {
  HttpReply reply = reply_of(405, {{"error", "method: this path takes " + allowed}});
  reply.allow = allowed;
  return reply;
}

Json to_json(const HostedRoom& room) {
  const RoomMeters& meters = room.meters();
  return {{"name", room.name()},
          {"stage", life_stage_name(room.stage())},
          {"locked", room.locked()},
          {"scene", room.scene_name()},
          {"seats", room.seats()},
          {"tick", meters.tick.get()},
          {"digest", protocol::hex16(meters.digest.get())},
          {"clients", meters.clients.get()},
          {"durable", meters.durable.get() == 1}};
}

/// What an act waits for; only what is said first counts.
class FirstAnswer {
 public:
  std::future<ActResult> given() { return promise_.get_future(); }
  /// Any thread.
  void give(ActResult result) {
    if (!said_.exchange(true)) promise_.set_value(std::move(result));
  }

 private:
  std::promise<ActResult> promise_;
  std::atomic<bool> said_{false};
};

std::optional<LifeAct> life_act_of(const std::string& verb) {
  for (const LifeAct act : {LifeAct::kLock, LifeAct::kUnlock, LifeAct::kPause, LifeAct::kResume,
                            LifeAct::kDrain, LifeAct::kEnd}) {
    if (verb == life_act_name(act)) return act;
  }
  return std::nullopt;
}

}  // namespace

/// What is asked for, as far as the path says.
struct Admin::Act {
  explicit Act(const std::string& body) : fields(body) {}
  std::string room;
  std::string verb;
  AdminFields fields;
};

Admin::Admin(Host& host, AdminOptions options)
    : host_(host),
      options_(std::move(options)),
      record_(host.logger()->clone(host.logger()->name())) {
  record_->set_level(spdlog::level::info);
}

bool equal_secrets(const std::string& a, const std::string& b) {
  ready_sodium();
  // Hashed first, so that the time does not depend on their lengths either.
  std::array<unsigned char, 32> hash_a{};
  std::array<unsigned char, 32> hash_b{};
  const auto hash = [](std::array<unsigned char, 32>& into, const std::string& of) {
    crypto_generichash(into.data(), into.size(), reinterpret_cast<const unsigned char*>(of.data()),
                       of.size(), nullptr, 0);
  };
  hash(hash_a, a);
  hash(hash_b, b);
  return equal_in_constant_time(std::as_bytes(std::span(hash_a)), std::as_bytes(std::span(hash_b)));
}

std::string read_admin_token(const std::string& path, std::string& mistake) {
  const auto read = read_text_file(path);
  if (!read) {
    mistake = path + ": cannot be read";
    return "";
  }
  std::string text = *read;
  const char* kSpace = " \t\r\n";
  text.erase(0, text.find_first_not_of(kSpace));
  text.erase(text.find_last_not_of(kSpace) + 1);
  if (text.size() < kAdminTokenBytesMin) {
    mistake = path + ": the token in it has " + std::to_string(text.size()) +
              " bytes, and must have at least " + std::to_string(kAdminTokenBytesMin);
    return "";
  }
  return text;
}

bool Admin::authorized(const HttpRequest& request) const {
  const std::string scheme = "Bearer ";
  return request.authorization.starts_with(scheme) &&
         equal_secrets(request.authorization.substr(scheme.size()), options_.token);
}

void Admin::note_stranger(const HttpRequest& request) {
  const std::lock_guard lock(strangers_mutex_);
  const auto now = std::chrono::steady_clock::now();
  ++strangers_unsaid_;
  if (now - stranger_said_ < kStrangerInterval) return;
  stranger_said_ = now;
  const Json line = {{"audit", "refused"},
                     {"from", request.from},
                     {"status", 401},
                     {"times", std::exchange(strangers_unsaid_, 0)}};
  record_->warn(line.dump());
}

HttpReply Admin::handle(const HttpRequest& request) {
  if (!authorized(request)) {
    note_stranger(request);
    return reply_of(401, {{"error", "Authorization: it must be \"Bearer \" and the token"}});
  }
  const HttpBody body = request.method == "POST" ? request.read_body() : HttpBody{};
  Act act(body.text);
  HttpReply reply =
      body.status == 200 ? route(request, act) : reply_of({body.status, body.mistake});
  if (request.method != "GET") audit(request, act, reply);
  return reply;
}

void Admin::audit(const HttpRequest& request, const Act& act, const HttpReply& reply) const {
  Json line = {{"audit", act.verb}, {"from", request.from}, {"status", reply.status}};
  if (act.verb.empty()) line["audit"] = request.path.substr(0, 128);
  if (!act.room.empty()) line["room"] = act.room;
  if (!act.fields.all().empty()) line["fields"] = act.fields.all();
  record_->info(line.dump(-1, ' ', false, Json::error_handler_t::replace));
}

HttpReply Admin::route(const HttpRequest& request, Act& act) {
  const bool posts = request.method == "POST";
  if (request.path == "/admin/rooms" && request.method == "GET") {
    Json rooms = Json::array();
    for (const auto& room : host_.rooms()) rooms.push_back(to_json(*room));
    return reply_of(200, {{"draining", host_.draining()}, {"rooms", rooms}});
  }
  if (request.path == "/admin/rooms") {
    if (!posts) return wrong_method("GET, POST");
    act.verb = "create";
    return reply_of(make(act));
  }
  if (request.path == "/admin/reload" || request.path == "/admin/drain") {
    if (!posts) return wrong_method("POST");
    act.verb = request.path.substr(std::string("/admin/").size());
    const bool drains = act.verb == "drain";
    const auto otherwise = static_cast<std::uint64_t>(host_.drain_time().count());
    const std::uint64_t deadline_ms =
        drains ? act.fields.number_or("deadline_ms", otherwise, kDeadlineMsMax) : 0;
    if (const std::string why = act.fields.mistake(); !why.empty()) return reply_of({400, why});
    if (drains) {
      host_.drain("an admin", std::chrono::milliseconds(deadline_ms));
      return reply_of(ActResult{202, ""});
    }
    if (!options_.reload) {
      return reply_of({409, "reload: the server was started without a configuration file"});
    }
    return reply_of(options_.reload());
  }
  if (request.path.starts_with("/admin/rooms/")) return act_on_room(request, act);
  return reply_of(404, {{"error", "path: there is no " + request.path.substr(0, 128)}});
}

HttpReply Admin::act_on_room(const HttpRequest& request, Act& act) {
  const std::string rest = request.path.substr(std::string("/admin/rooms/").size());
  const std::size_t slash = rest.find('/');
  const std::string name = rest.substr(0, slash);
  const auto room = host_.find(name);
  if (room == nullptr) {
    return reply_of({404, "path: there is no room \"" + name.substr(0, 64) + "\""});
  }
  act.room = name;
  if (slash == std::string::npos) {
    return request.method == "GET" ? reply_of(200, to_json(*room)) : wrong_method("GET");
  }
  act.verb = rest.substr(slash + 1);
  const bool known = life_act_of(act.verb) || act.verb == "kick" || act.verb == "snapshot" ||
                     act.verb == "rewind" || act.verb == "rotate" || act.verb == "reserve";
  if (!known) {
    const std::string verb = std::exchange(act.verb, "").substr(0, 64);
    return reply_of({404, "path: a room has no act \"" + verb + "\""});
  }
  if (request.method != "POST") return wrong_method("POST");
  return reply_of(perform(*room, act));
}

ActResult Admin::wait(const std::function<void(HostedRoom::Done)>& ask) const {
  const auto answer = std::make_shared<FirstAnswer>();
  auto result = answer->given();
  // Nothing of the host runs any more then, so no room would say anything.
  const std::stop_callback on_over(host_.over(), [answer] {
    answer->give({503, "the server goes away"});
  });
  ask([answer](ActResult done) { answer->give(std::move(done)); });
  if (result.wait_for(options_.patience) != std::future_status::ready) {
    return {504, "the room has not answered within " + std::to_string(options_.patience.count()) +
                     " ms; the act may still happen"};
  }
  return result.get();
}

ActResult Admin::make(Act& act) {
  const std::string name = act.fields.text("name");
  const std::string of_template = act.fields.text("template");
  if (const std::string why = act.fields.mistake(); !why.empty()) return {400, why};
  ActResult result =
      wait([&](HostedRoom::Done done) { host_.make_room(name, of_template, std::move(done)); });
  if (result.ok()) result.status = 201;
  return result;
}

ActResult Admin::snapshot(HostedRoom& room, Act& act) {
  const std::string file = act.fields.text("file");
  if (const std::string why = act.fields.mistake(); !why.empty()) return {400, why};
  if (options_.snapshot_directory.empty()) {
    return {409, "file: admin.snapshot_directory is not configured"};
  }
  if (const std::string why = room_name_mistake(file); !why.empty()) {
    return {400, "file: " + why + "; it lies in admin.snapshot_directory"};
  }
  return wait([&](HostedRoom::Done done) {
    room.write_snapshot(options_.snapshot_directory + "/" + file, std::move(done));
  });
}

/// "", or that the room has no such seat.
static std::string seat_mistake(const HostedRoom& room, std::uint16_t seat) {
  if (seat < room.seats()) return "";
  return "seat: it is " + std::to_string(seat) + ", and the room has " +
         std::to_string(room.seats()) + " from 0";
}

ActResult Admin::kick(HostedRoom& room, Act& act) {
  const auto seat = static_cast<std::uint16_t>(act.fields.number("seat", scenes::kSeatsMax - 1));
  const std::string reason = act.fields.text_or("reason", "by an admin");
  if (const std::string why = act.fields.mistake(); !why.empty()) return {400, why};
  if (const std::string why = seat_mistake(room, seat); !why.empty()) return {404, why};
  return wait([&](HostedRoom::Done done) { room.kick(seat, reason, std::move(done)); });
}

ActResult Admin::reserve(HostedRoom& room, Act& act) {
  const auto seat = static_cast<std::uint16_t>(act.fields.number("seat", scenes::kSeatsMax - 1));
  const std::string identity = act.fields.text_or("identity", "");
  const std::uint64_t ticks = act.fields.number("ticks", kTickMax);
  if (const std::string why = act.fields.mistake(); !why.empty()) return {400, why};
  if (ticks == 0) return {400, "ticks: it is 0, and must be at least 1"};
  if (identity.size() > kIdentityBytesMax) {
    return {400, "identity: it has " + std::to_string(identity.size()) + " bytes, of at most " +
                     std::to_string(kIdentityBytesMax)};
  }
  if (const std::string why = seat_mistake(room, seat); !why.empty()) return {404, why};
  return wait([&](HostedRoom::Done done) { room.reserve(seat, identity, ticks, std::move(done)); });
}

ActResult Admin::perform(HostedRoom& room, Act& act) {
  AdminFields& fields = act.fields;
  if (act.verb == "snapshot") return snapshot(room, act);
  if (act.verb == "rotate") {
    if (const std::string why = fields.mistake(); !why.empty()) return {400, why};
    return wait([&](HostedRoom::Done done) { room.rotate_log(std::move(done)); });
  }
  if (act.verb == "rewind") {
    const std::uint64_t tick = fields.number("tick", kTickMax);
    if (const std::string why = fields.mistake(); !why.empty()) return {400, why};
    return wait([&](HostedRoom::Done done) { room.rewind(tick, std::move(done)); });
  }
  if (act.verb == "kick") return kick(room, act);
  if (act.verb == "reserve") return reserve(room, act);
  const LifeAct life = *life_act_of(act.verb);
  const bool ends = life == LifeAct::kEnd || life == LifeAct::kDrain;
  const std::string reason = ends ? fields.text_or("reason", "by an admin") : "";
  const auto otherwise = static_cast<std::uint64_t>(host_.drain_time().count());
  const std::uint64_t deadline_ms =
      life == LifeAct::kDrain ? fields.number_or("deadline_ms", otherwise, kDeadlineMsMax) : 0;
  if (const std::string why = fields.mistake(); !why.empty()) return {400, why};
  return wait([&](HostedRoom::Done done) {
    room.act(life, reason, std::chrono::milliseconds(deadline_ms), std::move(done));
  });
}

}  // namespace cycloid::server
