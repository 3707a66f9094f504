// A mote's uses of its messages: code_size_test.sh bounds the size of these functions on an
// ATmega128. A function is a message and a use.
#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"

using namespace rubric;
using namespace rubric::rubicon;

#define MOTE_USE extern "C" __attribute__((noinline, used))

MOTE_USE bool join_request_parse(const uint8_t* p, size_t n, JoinRequest& out) {
  const Result<JoinRequestView> view = JoinRequestView::parse(Bytes(p, n));
  if (!view) return false;
  out = view->to_value();
  return true;
}
MOTE_USE size_t join_request_write(const JoinRequest& value, uint8_t* p, size_t n) {
  const Result<MutableBytes> out = write(value, MutableBytes(p, n));
  return out ? out->size() : 0;
}
MOTE_USE bool join_reply_parse(const uint8_t* p, size_t n, JoinReply& out) {
  const Result<JoinReplyView> view = JoinReplyView::parse(Bytes(p, n));
  if (!view) return false;
  out = view->to_value();
  return true;
}
MOTE_USE size_t join_reply_write(const JoinReply& value, uint8_t* p, size_t n) {
  const Result<MutableBytes> out = write(value, MutableBytes(p, n));
  return out ? out->size() : 0;
}
MOTE_USE bool ack_join_parse(const uint8_t* p, size_t n, AckJoin& out) {
  const Result<AckJoinView> view = AckJoinView::parse(Bytes(p, n));
  if (!view) return false;
  out = view->to_value();
  return true;
}
MOTE_USE size_t ack_join_write(const AckJoin& value, uint8_t* p, size_t n) {
  const Result<MutableBytes> out = write(value, MutableBytes(p, n));
  return out ? out->size() : 0;
}
MOTE_USE bool net_msg_parse(const uint8_t* p, size_t n, NetMsg& out) {
  const Result<NetMsgView> view = NetMsgView::parse(Bytes(p, n));
  if (!view) return false;
  out = view->to_value();
  return true;
}
MOTE_USE size_t net_msg_write(const NetMsg& value, uint8_t* p, size_t n) {
  const Result<MutableBytes> out = write(value, MutableBytes(p, n));
  return out ? out->size() : 0;
}
MOTE_USE bool app_msg_parse(const uint8_t* p, size_t n, AppMsg& out) {
  const Result<AppMsgView> view = AppMsgView::parse(Bytes(p, n));
  if (!view) return false;
  out = view->to_value();
  return true;
}
MOTE_USE size_t app_msg_write(const AppMsg& value, uint8_t* p, size_t n) {
  const Result<MutableBytes> out = write(value, MutableBytes(p, n));
  return out ? out->size() : 0;
}
MOTE_USE bool rubicon_ack_parse(const uint8_t* p, size_t n, RubiconAck& out) {
  const Result<RubiconAckView> view = RubiconAckView::parse(Bytes(p, n));
  if (!view) return false;
  out = view->to_value();
  return true;
}
MOTE_USE size_t rubicon_ack_write(const RubiconAck& value, uint8_t* p, size_t n) {
  const Result<MutableBytes> out = write(value, MutableBytes(p, n));
  return out ? out->size() : 0;
}
// Returns only whether a message is for this mote, and its number.
MOTE_USE uint16_t net_msg_view(const uint8_t* p, size_t n, uint16_t devid) {
  const Result<NetMsgView> view = NetMsgView::parse(Bytes(p, n));
  if (!view || view->dest().devid() != Devid(devid)) return 0xffff;
  return view->seq_num();
}
