// Property: none. A trap follows four valid messages in order, each of which has to repeat earlier
// values. planted_test.py shows that the structure-aware mutator reaches it.
#include <cstddef>
#include <cstdint>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/runtime/hdlc.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;

constexpr std::size_t kAmHeaderBytes = 8;

/// A mote joins and sends something that is to be confirmed. Other messages may come between.
class Join {
 public:
  /// Takes content. Serial packets carry radio messages as well, as in a trace.
  void take(Bytes content) {
    if (content.empty()) return;
    const std::size_t head = content[0] == kSerialPacketAck ? 2 : 1;
    if (head == 1 && content[0] != kSerialPacketNoAck) return;
    if (content.size() < head + kAmHeaderBytes) return;
    const Bytes packet = content.from(head);
    const Bytes payload = packet.from(kAmHeaderBytes);
    if (packet[0] != 0 || packet[5] != payload.size()) return;
    switch (packet[7]) {
      case 14: return request(payload);
      case 15: return reply(payload);
      case 29: return ack(payload);
      case 28: return message(payload);
      default: return;
    }
  }

 private:
  bool is_mote(rubicon::RAddrView address) const {
    return static_cast<std::uint16_t>(address.devid()) == mote_;
  }

  void request(Bytes payload) {
    const auto view = rubicon::JoinRequestView::parse(payload);
    if (!view || !view->stale().empty() || step_ != 0) return;
    // Small and special numbers may come from anywhere.
    if (view->seq_num() < 256 || view->seq_num() == 0xFFFF) return;
    seq_num_ = view->seq_num();
    step_ = 1;
  }

  void reply(Bytes payload) {
    const auto view = rubicon::JoinReplyView::parse(payload);
    if (!view || !view->stale().empty() || step_ != 1) return;
    if (view->seq_num() != seq_num_) return;
    if (view->mote_addr() < 256 || view->mote_addr() >= 0xFFFD) return;
    mote_ = view->mote_addr();
    step_ = 2;
  }

  void ack(Bytes payload) {
    const auto view = rubicon::AckJoinView::parse(payload);
    if (!view || !view->stale().empty() || step_ != 2) return;
    if (view->seq_num() != seq_num_) return;
    if (!is_mote(view->src())) return;
    step_ = 3;
  }

  void message(Bytes payload) {
    const auto view = rubicon::NetMsgView::parse(payload);
    if (!view || step_ != 3 || view->reliable() != 1) return;
    if (!is_mote(view->src())) return;
    fuzz::require(false, "nobody gets here");
  }

  int step_ = 0;
  std::uint16_t seq_num_ = 0;
  std::uint16_t mote_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Join join;
  std::uint8_t buffer[256];
  HdlcDeframer deframer(buffer);
  for (const std::uint8_t byte : Bytes(data, size)) {
    if (deframer.push(byte) == HdlcEvent::kFrame) join.take(deframer.content());
  }
  return 0;
}
