// Lines of text in which a sniffer or a simulator states a radio frame and facts about it.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/containers/packet.h"

namespace rubric {

/// A radio frame of a line of text.
struct RadioLine {
  std::uint16_t link_type = 0;     ///< Says whether the frame ends with its FCS.
  std::int64_t time_ns = kNoTime;  ///< Since the sniffer or the simulation started.
  RadioFacts radio;
};

/// Reads a line that is as one of these write it, and puts the bytes of its frame into `bytes`:
///   received: HEX power: DBM lqi: LQI time: US    Nordic's sniffer; the last two bytes of HEX are
///                                                 none of the frame's
///   psdu: HEX power: DBM lqi: LQI time: US        Zephyr's, without FCS
///   MS<tab>NODE<tab>NODES<tab>SIZE: 0xHEX HEX     Cooja's log of radio messages; an FCS that fits
///                                                 is one
/// Returns false for any other line. Source: nRF Sniffer for 802.15.4, nrf802154_sniffer.py;
/// Zephyr, samples/net/ieee802154/sniffer; Cooja, RadioLogger.
bool read_radio_line(Bytes text, RadioLine& line, std::vector<std::uint8_t>& bytes);

}  // namespace rubric
