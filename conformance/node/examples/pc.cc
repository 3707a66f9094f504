// A sink and a mote in one program, over air that loses nothing: the mote joins and asks the sink,
// reliably, to open a door. Time is virtual.
#include <cstdio>
#include <vector>

#include "conformance/node/node.h"

using namespace rubric::node;
using rubric::Bytes;

constexpr uint8_t kMockup = 5;  // An APPID.

class Station : public Driver, public Application {
 public:
  Station(const char* name, const Setup& setup) : name_(name), node_(*this, *this) {
    node_.start(setup);
  }
  Node& node() { return node_; }
  void reach(Station& other) { others_.push_back(&other); }

  // The driver. The air has a copy, so that the node may go on when the frame has ended.
  void transmit(Line, Bytes packet, bool) override {
    sending_.assign(packet.begin(), packet.end());
  }
  // Ends a frame; returns false if there is none.
  bool end_frame() {
    if (sending_.empty()) return false;
    const std::vector<uint8_t> frame = std::move(sending_);
    sending_.clear();
    for (Station* one : others_)
      one->node_.received(Line::kRadio, Bytes(frame.data(), frame.size()));
    node_.sent(Line::kRadio, true);
    return true;
  }

  // The application.
  void joined(Address own, bool success) override {
    std::printf("%s: joined %u:%u %s\n", name_, own.pid, own.devid, success ? "well" : "in vain");
    const uint8_t open_door[] = {1};
    node_.send({own.pid, kSinkId}, kMockup, true, Bytes(open_door));
  }
  void mote_joined(Address mote, const Descriptor&) override {
    std::printf("%s: mote %u is a member\n", name_, mote.devid);
  }
  void received(Address src, uint8_t app_id, Bytes data) override {
    std::printf("%s: %zu bytes for application %u from %u:%u\n", name_, data.size(), app_id,
                src.pid, src.devid);
  }
  void ack_received(uint8_t, uint16_t seq_num, bool success) override {
    std::printf("%s: message %u %s\n", name_, seq_num, success ? "acked" : "lost");
  }
  void syn_data_received(ChannelId, DataStatus) override {}

 private:
  const char* name_;
  SizedNode<AnySizes> node_;
  std::vector<Station*> others_;
  std::vector<uint8_t> sending_;
};

int main() {
  Station sink("sink", {Role::kSink, kSinkId, 11, 4, 0, 0});
  Station mote("mote", {Role::kMote, 5, 0, 4, 999, 0});
  sink.reach(mote);
  mote.reach(sink);
  mote.node().join(Descriptor());
  for (Ticks now = 0; now < 2048; ++now) {
    Ticks due;
    sink.node().run(now, due);
    mote.node().run(now, due);
    while (sink.end_frame() || mote.end_frame()) {
    }
  }
  return mote.node().is_member() ? 0 : 1;
}
