#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/desync/inquiry.hpp"
#include "server/room/inquiry.hpp"

namespace cycloid::server {

/// What the inquiries of a room need of its host.
struct RoomInquiryHooks {
  std::function<std::int64_t()> now_ns;  ///< Never goes back.
  /// Runs `work` on another thread and then `done` on the room's. Empty: both at once, here.
  std::function<void(std::function<void()> work, std::function<void()> done)> later{};
  /// Looks into a finding, such as ReportSink::publish; called as `work`, by any thread.
  /// @returns what to tell the client's user, "" for nothing.
  std::function<std::string(const Finding&)> publish;
};

/// A DesyncDesk as a Room knows it. Its findings go through the hooks, and what comes of them is
/// told to the client in a RoomNotice.
class RoomInquiry final : public DesyncInquiry {
 public:
  RoomInquiry(DesyncDeskOptions options, std::shared_ptr<const RoomIdentity> room,
              RoomInquiryHooks hooks)
      : desk_(options, std::move(room)), hooks_(std::move(hooks)) {}

  InquiryAnswer on_mismatch(const Mismatch& mismatch, const RoomEvidence& evidence) override;
  InquiryAnswer on_tick_digests(PeerId peer, const protocol::TickDigests& digests,
                                const RoomEvidence& evidence) override;
  InquiryAnswer on_state_part(PeerId peer, const protocol::StatePart& part,
                              const RoomEvidence& evidence) override;
  void on_gone(PeerId peer) override { desk_.on_leave(peer); }
  void on_break(const std::string& why, const RoomEvidence& evidence) override;
  void on_digest(PeerId peer, std::uint64_t tick, std::uint64_t digest) override {
    desk_.on_digest(peer, tick, digest);
  }
  std::vector<std::pair<PeerId, protocol::ServerMessage>> take_messages(
      const RoomEvidence& evidence) override;

  const DesyncDesk& desk() const { return desk_; }

 private:
  void publish(Finding found);

  using Told = std::vector<std::pair<PeerId, protocol::ServerMessage>>;

  DesyncDesk desk_;
  RoomInquiryHooks hooks_;
  std::shared_ptr<Told> told_ = std::make_shared<Told>();  ///< Outlives this in a `done`.
};

}  // namespace cycloid::server
