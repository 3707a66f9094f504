#include "conformance/simulate/capture_recorder.h"

#include <utility>

#include "codec/containers/link_record.h"
#include "codec/runtime/crc16.h"
#include "codec/runtime/hdlc.h"
#include "codec/runtime/ieee802154_fcs.h"

namespace rubric::simulate {
namespace {

constexpr std::int64_t kNsPerUs = 1'000;

}  // namespace

CaptureRecorder::CaptureRecorder(const Network& network) {
  for (const RadioPlan& radio : network.radios) {
    radio_names_.push_back(network.radios.size() == 1 ? "radio" : "radio:" + radio.name);
  }
  // Every sink has the TinyOS id 1, so the id cannot tell them apart.
  for (std::size_t i = 0; i < network.serials.size(); ++i) {
    const machine::Config& sink = network.nodes.at(network.serials[i].sink).config;
    serial_names_.push_back("serial:" + std::to_string(100 * i + sink.id));
  }
  writer_.begin(out_);
}

void CaptureRecorder::write(Micros time_us, Packet& packet, std::string_view interface_name) {
  packet.time_ns = time_us * kNsPerUs;
  writer_.write(packet, interface_name, out_);
}

void CaptureRecorder::on_air(Micros time_us, std::size_t radio, Bytes frame) {
  Packet packet;
  packet.framing = Framing::kRadio;
  packet.link_type = kLinkRadioFcs;
  packet.fcs = fcs(frame);
  packet.bytes = frame;
  write(time_us, packet, radio_names_.at(radio));
}

void CaptureRecorder::on_serial(Micros time_us, std::size_t line, bool to_sink,
                                const SerialFrame& frame) {
  Packet packet;
  packet.framing = Framing::kHdlc;
  packet.link_type = kLinkSerial;
  packet.direction = to_sink ? Direction::kInbound : Direction::kOutbound;
  packet.kind = frame.kind;
  packet.serial_seq = frame.seq;
  std::uint16_t crc = crc16_step(0, frame.kind);
  if (frame.seq >= 0) crc = crc16_step(crc, static_cast<std::uint8_t>(frame.seq));
  packet.crc = crc16(frame.packet, crc);
  packet.bytes = frame.packet;
  write(time_us, packet, serial_names_.at(line));
}

std::string CaptureRecorder::finish() {
  writer_.finish(out_);
  return std::move(out_);
}

}  // namespace rubric::simulate
