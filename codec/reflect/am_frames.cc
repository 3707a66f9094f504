#include "codec/reflect/am_frames.h"

#include <algorithm>

namespace rubric::reflect {

std::vector<std::uint8_t> serial_packet(const ActiveMessage& am, Bytes payload) {
  tinyos::AmHeader header;
  header.dispatch = tinyos::Dispatch::kActiveMessage;
  header.dest = am.dest;
  header.src = am.src;
  header.length = static_cast<std::uint8_t>(payload.size());
  header.group = am.group;
  header.type = am.type;
  std::vector<std::uint8_t> out(kAmHeaderBytes + payload.size());
  tinyos::AmHeaderLayout::store(header, out.data());
  std::copy(payload.begin(), payload.end(), out.begin() + kAmHeaderBytes);
  return out;
}

std::vector<std::uint8_t> radio_frame(const MacHeader& mac, std::uint8_t am_type, Bytes payload) {
  using Layout = rubicon::RadioIFrameLayout;
  rubicon::RadioIFrame frame;
  frame.mac.fcf = mac.fcf;
  frame.mac.dsn = mac.dsn;
  frame.mac.destpan = mac.destpan;
  frame.mac.dest = mac.dest;
  frame.mac.src = mac.src;
  frame.network = Layout::NetworkAt::kMin;
  frame.type = static_cast<rubicon::AmType>(am_type);
  frame.payload = payload;
  std::vector<std::uint8_t> out(Layout::size_bytes(frame));
  Layout::store(frame, out.data());
  return out;
}

}  // namespace rubric::reflect
