#include "codec/reflect/am_frames.h"

#include <algorithm>

namespace rubric::reflect {

std::vector<std::uint8_t> serial_packet(tinyos::AmHeader header, Bytes payload) {
  header.length = static_cast<std::uint8_t>(payload.size());
  std::vector<std::uint8_t> out(kAmHeaderBytes + payload.size());
  tinyos::AmHeaderLayout::store(header, out.data());
  std::copy(payload.begin(), payload.end(), out.begin() + kAmHeaderBytes);
  return out;
}

std::vector<std::uint8_t> radio_frame(const tinyos::MacHeader& mac, std::uint8_t am_type,
                                      Bytes payload) {
  using Layout = rubicon::RadioIFrameLayout;
  const rubicon::RadioIFrame frame{mac, Layout::NetworkAt::kMin,
                                   static_cast<rubicon::AmType>(am_type), payload};
  std::vector<std::uint8_t> out(Layout::size_bytes(frame));
  Layout::store(frame, out.data());
  return out;
}

}  // namespace rubric::reflect
