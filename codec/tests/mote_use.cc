// A mote's uses of its messages: code_size_test.sh bounds the size of these functions on an
// ATmega128. A function is a message and a use.
#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"

using namespace rubric;
using namespace rubric::rubicon;

#define MOTE_USE extern "C" __attribute__((noinline, used))

#define MOTE_USES(name, Name)                                             \
  MOTE_USE bool name##_parse(const uint8_t* p, size_t n, Name& out) {     \
    const Result<Name##View> view = Name##View::parse(Bytes(p, n));       \
    if (!view) return false;                                              \
    out = view->to_value();                                               \
    return true;                                                          \
  }                                                                       \
  MOTE_USE size_t name##_write(const Name& value, uint8_t* p, size_t n) { \
    const Result<MutableBytes> out = write(value, MutableBytes(p, n));    \
    return out ? out->size() : 0;                                         \
  }

MOTE_USES(join_request, JoinRequest)
MOTE_USES(join_reply, JoinReply)
MOTE_USES(ack_join, AckJoin)
MOTE_USES(net_msg, NetMsg)
MOTE_USES(app_msg, AppMsg)
MOTE_USES(rubicon_ack, RubiconAck)

// Returns only whether a message is for this mote, and its number.
MOTE_USE uint16_t net_msg_view(const uint8_t* p, size_t n, uint16_t devid) {
  const Result<NetMsgView> view = NetMsgView::parse(Bytes(p, n));
  if (!view || view->dest().devid() != Devid(devid)) return 0xffff;
  return view->seq_num();
}
