#include <utility>

#include "server/host/host.hpp"
#include "server/host/process_time.hpp"

// How rooms come to be: by an act, or by the first who names them.

namespace cycloid::server {
namespace {

constexpr int kBadRequest = 400;
constexpr int kNoSuchTemplate = 404;
constexpr int kNameTaken = 409;
constexpr int kCannotRun = 422;
constexpr int kNoneMore = 503;

RoomFound found_by(protocol::Refusal code) {
  if (code == protocol::Refusal::kRoomLocked) return RoomFound::kLocked;
  return code == protocol::Refusal::kRoomFull ? RoomFound::kFull : RoomFound::kDraining;
}

/// What a peer is told of a room that is not made. Why a disk or a scene fails is the operator's
/// business: it may name paths.
protocol::Refused refusal_of(const ActResult& made, bool draining) {
  if (made.status == kNoneMore)
    return {draining ? protocol::Refusal::kDraining : protocol::Refusal::kRoomFull, made.text};
  return {protocol::Refusal::kNoSuchRoom, "the server cannot make this room"};
}

}  // namespace

std::string room_name_mistake(const std::string& name) {
  if (name.empty() || name.size() > protocol::kRoomNameBytesMax) {
    return "a name has 1 to " + std::to_string(protocol::kRoomNameBytesMax) + " characters, not " +
           std::to_string(name.size());
  }
  for (const char c : name) {
    const bool known = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '_' || c == '.' || c == ':';
    if (!known) return "a name is made of letters, digits and -_.: of ASCII";
  }
  return name[0] == '.' ? "a name does not begin with a dot" : "";
}

ActResult Host::reserve(const std::string& name, const std::string& of_template,
                        RoomSettings& settings, std::uint32_t& slot) {
  if (std::string why = room_name_mistake(name); !why.empty()) {
    return {kBadRequest, "name: " + why};
  }
  const auto known = options_.templates.find(of_template);
  if (known == options_.templates.end()) {
    return {kNoSuchTemplate, "template: there is none of the name \"" + of_template + "\""};
  }
  if (draining_) return {kNoneMore, "the server goes away"};
  const std::lock_guard lock(directory_mutex_);
  if (directory_.contains(name)) return {kNameTaken, "name: there is a room " + name};
  if (directory_.size() >= limits_.rooms_max) {
    return {kNoneMore, std::to_string(directory_.size()) + " rooms, of at most " +
                           std::to_string(limits_.rooms_max)};
  }
  settings = known->second.settings;
  settings.limits = limits_.room;
  slot = 0;
  while (slots_.contains(slot)) ++slot;
  slots_.insert(slot);
  directory_.emplace(name, nullptr);
  return {};
}

void Host::make_room(const std::string& name, const std::string& of_template,
                     HostedRoom::Done done) {
  auto work = [this, name, of_template, done = std::move(done)] {
    RoomSettings settings;
    std::uint32_t slot = 0;
    ActResult result = reserve(name, of_template, settings, slot);
    if (!result.ok()) return answer(done, std::move(result));
    build(name, std::move(settings), slot, done);
  };
  asio::post(accept_strand_, std::move(work));
}

void Host::build(const std::string& name, RoomSettings settings, std::uint32_t slot,
                 HostedRoom::Done done) {
  // The pool must not end while a room is being made that it is to run.
  auto guard = asio::make_work_guard(io_);
  auto work = [this, name, slot, settings = std::move(settings), done = std::move(done),
               guard]() mutable {
    std::shared_ptr<HostedRoom> made;
    ActResult result;
    try {
      made = std::make_shared<HostedRoom>(site(), name, std::move(settings), slot);
    } catch (const std::system_error& error) {
      result = {kCannotWrite, error.what()};
    } catch (const std::invalid_argument& error) {
      result = {kCannotRun, error.what()};
    }
    asio::post(accept_strand_, [this, name, slot, made, result, done] {
      if (made == nullptr) {
        forget(name, slot);
      } else {
        Limits limits;
        {
          const std::lock_guard lock(directory_mutex_);
          directory_[name] = made;
          limits = limits_.room;
        }
        meters_->rooms_made.add();
        options_.logger->info("room {} is made of {}", name, made->scene_name());
        made->start();
        made->set_limits(limits);  // They may be others than when its making began.
        if (draining_) {
          made->act(LifeAct::kEnd, "the server goes away", std::chrono::milliseconds(0), {});
        }
      }
      let_joiners_in(name, result);
      answer(done, result);
    });
  };
  asio::post(slow_, std::move(work));
}

void Host::forget(const std::string& name, std::uint32_t slot) {
  {
    const std::lock_guard lock(directory_mutex_);
    directory_.erase(name);
    slots_.erase(slot);
  }
  finish_if_over();
}

std::shared_ptr<HostedRoom> Host::find_or_only(const std::string& wanted) const {
  if (!wanted.empty()) return find(wanted);
  const auto all = rooms();
  return all.size() == 1 ? all.front() : nullptr;
}

bool Host::makes_on_join(const std::string& wanted) const {
  const std::size_t colon = wanted.find(':');
  if (colon == std::string::npos || !room_name_mistake(wanted).empty()) return false;
  const auto known = options_.templates.find(wanted.substr(0, colon));
  return known != options_.templates.end() && known->second.on_first_join;
}

RoomVerdict Host::judge(const std::string& wanted, const Admission& admission) const {
  if (const auto room = find_or_only(wanted)) {
    const auto closed = room->closed(admission);
    if (!closed) return {RoomFound::kExists, ""};
    return {found_by(closed->code), closed->reason};
  }
  if (wanted.empty()) {
    return {RoomFound::kNoSuchRoom,
            "the hello names no room, and here are " + std::to_string(rooms().size())};
  }
  // Who comes back shows a secret, and a room that is not there knows none.
  if (!admission.hello.resume.empty() || !makes_on_join(wanted)) {
    return {RoomFound::kNoSuchRoom, "there is no room \"" + wanted + "\""};
  }
  const std::lock_guard lock(directory_mutex_);
  const bool there = directory_.contains(wanted);  // It is being made for somebody else.
  if (there || directory_.size() < limits_.rooms_max) return {RoomFound::kCreated, ""};
  return {RoomFound::kFull, std::to_string(directory_.size()) + " rooms, of at most " +
                                std::to_string(limits_.rooms_max)};
}

void Host::on_admitted(Entrant entrant) {
  const std::string wanted = entrant.admission.hello.room;
  if (const auto room = find_or_only(wanted)) return room->enter(std::move(entrant));
  join_new_room(wanted, std::move(entrant));
}

void Host::join_new_room(const std::string& name, Entrant entrant) {
  const auto [found, first] = joining_.try_emplace(name);
  found->second.push_back(std::move(entrant));
  if (!first) return;  // It is being made.
  auto joined = [this, name](const ActResult& result) {
    // Somebody else is making it; they are let in when it is made.
    if (result.status == kNameTaken && find(name) == nullptr) return;
    let_joiners_in(name, result);
  };
  make_room(name, name.substr(0, name.find(':')), std::move(joined));
}

void Host::let_joiners_in(const std::string& name, const ActResult& made) {
  auto waiting = joining_.extract(name);
  if (waiting.empty()) return;
  const auto room = find(name);
  const protocol::Refused refused = refusal_of(made, draining_);
  if (room == nullptr && made.text != refused.reason && cannot_lines_.take(1, process_now_ns())) {
    options_.logger->error("room {} cannot be made: {}", name, made.text);
  }
  for (Entrant& joiner : waiting.mapped()) {
    if (room != nullptr) {
      room->enter(std::move(joiner));
    } else {
      gatehouse_->turn_away(std::move(joiner), refused);
    }
  }
}

}  // namespace cycloid::server
