#include "server/desync/room_inquiry.hpp"

#include <limits>

namespace cycloid::server {

RoomInquiry::RoomInquiry(DesyncDeskOptions options, std::shared_ptr<const RoomIdentity> room,
                         const scenes::Simulation& start, RoomInquiryHooks hooks)
    : desk_(options, std::move(room)), hooks_(std::move(hooks)) {
  desk_.start(start);
}

InquiryAnswer RoomInquiry::on_mismatch(const Mismatch& mismatch, const RoomEvidence&) {
  desk_.on_mismatch({mismatch.peer, mismatch.name, mismatch.build, mismatch.seat},
                    {mismatch.tick, mismatch.theirs}, hooks_.now_ns());
  return {};
}

InquiryAnswer RoomInquiry::on_tick_digests(PeerId peer, const protocol::TickDigests& digests,
                                           const RoomEvidence&) {
  InquiryAnswer answer;
  if (const auto wanted = desk_.on_tick_digests(peer, digests))
    answer.messages.emplace_back(*wanted);
  return answer;
}

InquiryAnswer RoomInquiry::on_state_part(PeerId peer, const protocol::StatePart& part,
                                         const RoomEvidence&) {
  desk_.on_state_part(peer, part);
  return {};
}

std::vector<std::pair<PeerId, protocol::ServerMessage>> RoomInquiry::take_messages() {
  // How many replicas could vote is not known here, so the desk waits its time for them.
  const std::size_t all = std::numeric_limits<std::size_t>::max();
  for (Finding& found : desk_.take_findings(hooks_.now_ns(), all)) {
    const auto finding = std::make_shared<const Finding>(std::move(found));
    const auto text = std::make_shared<std::string>();
    auto work = [publish = hooks_.publish, finding, text] { *text = publish(*finding); };
    auto done = [told = told_, finding, text] {
      if (text->empty()) return;
      told->emplace_back(finding->client.peer, protocol::RoomNotice{protocol::NoticeKind::kReport,
                                                                    finding->tick, 0, *text});
    };
    if (hooks_.later) {
      hooks_.later(std::move(work), std::move(done));
    } else {
      work();
      done();
    }
  }
  return std::exchange(*told_, {});
}

}  // namespace cycloid::server
