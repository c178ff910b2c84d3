#include "server/desync/room_inquiry.hpp"

namespace cycloid::server {

InquiryAnswer RoomInquiry::on_mismatch(const Mismatch& mismatch, const RoomEvidence& evidence) {
  desk_.on_mismatch({mismatch.peer, mismatch.name, mismatch.build, mismatch.seat},
                    {mismatch.tick, mismatch.theirs}, hooks_.now_ns(), evidence);
  return {};
}

InquiryAnswer RoomInquiry::on_tick_digests(PeerId peer, const protocol::TickDigests& digests,
                                           const RoomEvidence& evidence) {
  InquiryAnswer answer;
  if (const auto wanted = desk_.on_tick_digests(peer, digests, evidence))
    answer.messages.emplace_back(*wanted);
  return answer;
}

InquiryAnswer RoomInquiry::on_state_part(PeerId peer, const protocol::StatePart& part,
                                         const RoomEvidence& evidence) {
  desk_.on_state_part(peer, part, evidence);
  return {};
}

void RoomInquiry::on_break(const std::string& why, const RoomEvidence& evidence) {
  for (Finding& found : desk_.close(why, evidence)) publish(std::move(found));
}

std::vector<std::pair<PeerId, protocol::ServerMessage>> RoomInquiry::take_messages(
    const RoomEvidence& evidence) {
  for (Finding& found : desk_.take_findings(hooks_.now_ns(), evidence)) publish(std::move(found));
  return std::exchange(*told_, {});
}

void RoomInquiry::publish(Finding found) {
  const auto finding = std::make_shared<const Finding>(std::move(found));
  const auto text = std::make_shared<std::string>();
  auto work = [publish = hooks_.publish, finding, text] { *text = publish(*finding); };
  auto done = [told = told_, finding, text] {
    if (text->empty()) return;
    told->emplace_back(finding->client.peer, protocol::RoomNotice{protocol::NoticeKind::kReport,
                                                                  finding->tick, 0, *text});
  };
  if (hooks_.later) return hooks_.later(std::move(work), std::move(done));
  work();
  done();
}

}  // namespace cycloid::server
