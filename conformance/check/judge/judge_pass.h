// The second pass: shows each observation to the parts that judge it.
#pragma once

#include <cstdint>
#include <map>
#include <set>

#include "conformance/check/judge/acks.h"
#include "conformance/check/judge/announcements.h"
#include "conformance/check/judge/forward.h"
#include "conformance/check/judge/interface_watch.h"
#include "conformance/check/judge/join_calls.h"
#include "conformance/check/judge/join_watch.h"
#include "conformance/check/judge/mote_join.h"
#include "conformance/check/judge/peis_watch.h"
#include "conformance/check/judge/sent.h"
#include "conformance/check/judge/sink_join.h"
#include "conformance/check/judge/synaptic_watch.h"
#include "conformance/machine/route.h"

namespace rubric::check {

class Judge {
 public:
  Judge(const Run& run, const Options& options);
  Report judge();
  const TapsCross& taps_cross() const { return context_.taps_cross(); }

 private:
  bool is(std::uint16_t device, machine::Role role) const;
  machine::Address address_of(std::uint16_t node) const;
  std::int64_t ack_timeout_us(machine::Address address) const;
  void look(std::uint32_t index);
  // Judges what a node should have done by now, where its log has all that it did.
  void malformed(const Observation& seen);
  void overdue(std::uint16_t device, std::int64_t now_us);
  /// Forgets what the device knew before that time, at which its life began at the earliest: it
  /// may have heard what came since.
  void begin_life(std::uint16_t device, std::int64_t since_us);
  // Takes the link's own repetition, or a log's line that shows who received a frame.
  void repeated(std::uint32_t index, const Observation& seen, const Mark& mark);
  // Takes a log's line that gives a node a message that is known from its sender.
  void surely(const Observation& seen, const Mark& mark, const Net& net);
  void given_off(const Observation& seen, const Mark& mark, const Net& net);
  // Returns the sink that surely received a frame for the sinks' address.
  std::uint16_t sure_sink(std::uint32_t index) const;
  void radio(std::uint32_t index, const Observation& seen, const Mark& mark);
  // Takes a join message that is known from its sender: a log's line that gives it to a node, or
  // the link's repetition, which a node may have heard instead of the first or as well.
  void joins_heard(std::uint32_t index, const Observation& seen, const Mark& mark);
  // Takes a reply. Motes whose log has what they were given hear nothing else.
  void replied(std::uint32_t index, const Observation& seen, const Mark& mark, const Reply& reply);
  void cut_off(const Observation& seen, std::uint16_t sender);
  void island_told(std::uint16_t sink, const Place& at, std::uint16_t island, bool sure);
  void island_shown(std::uint16_t sink, std::uint16_t before, std::int64_t now_us);
  bool is_sinks_own(std::uint16_t sink, const Observation& seen, const Net& net);
  void role_broken(ReqId rule, const char* what, const Observation& seen, std::uint16_t device);
  void radio_net(std::uint32_t index, const Observation& seen, const Mark& mark, const Net& net);
  // Takes a message of the node's own.
  void own_message(std::uint16_t node, const Observation& seen, const Net& net, machine::Link link,
                   machine::Address own);
  // Judges a message that only the node's own application can have asked for, under another name.
  // Returns whether it is one.
  bool forged(std::uint16_t node, const Observation& seen, const Net& net, machine::Link link,
              machine::Address own);
  // Takes what a base station, whose address is `own`, hands to its sink in another's name.
  void handed_down(std::uint16_t base, const Observation& seen, const Net& net,
                   machine::Address own);
  // Returns whether a message may be dropped as it is not whole (N11-SHORT).
  bool cut_on_line(std::uint16_t node, const Observation& seen) const {
    return who_.devices[node].whole && seen.kind == Observation::Kind::kSerial &&
           seen.frame.payload.size() < rubicon::NetMsgView::kMaxSizeBytes;
  }
  enum class Standing : std::uint8_t { kOutside, kUnknown, kPerhaps, kMember };
  Standing standing(std::uint16_t node) const;
  void mote_hears(std::uint32_t index, std::uint16_t mote, const Observation& seen,
                  const Mark& mark, const Net& net);
  void hears(std::uint16_t node, const machine::Router& router, machine::Link from,
             const Observation& seen, std::uint16_t sender, const Net& net, bool sure);
  // Returns whether the ack of a message to the node may find no room.
  bool no_room(std::uint16_t node, const Net& net) const;
  // Counts an ack at the originator of the acked message, or at nobody if by a log it was given to
  // `given` while that interface was off.
  void ack_comes(std::uint32_t index, const Net& ack, const Observation& seen, std::uint16_t given);
  void serial(std::uint32_t index, const Observation& seen, const Mark& mark);
  // Judges the length of a net_msg on a serial line, the first one that is cut short of a sender.
  void whole(const Observation& seen, std::uint16_t sender);
  /// `passes`: a message that it heard.
  void up_serial(const Observation& seen, const Mark& mark, std::uint16_t sink, const Net& net,
                 bool passes);
  void base_station_hears(std::uint16_t sink, const Observation& seen, const Mark& mark,
                          const Net& net);
  void down_serial(std::uint32_t index, const Observation& seen, const Mark& mark,
                   std::uint16_t sink, const Net& net);
  // Takes a message between base stations, by the log of `base`.
  void peis(const Observation& seen, std::uint16_t base);
  void called(const Observation& seen, std::uint16_t device);
  void told(const Observation& seen, std::uint16_t device);

  const Run& run_;
  Identity who_;
  Findings findings_;
  Context context_;
  MoteJoins motes_;
  JoinCalls join_calls_;
  SinkJoins sinks_;
  Announcements announcements_;
  JoinWatch joins_;
  Forwarding forwarding_;
  Originals originals_;
  Acks acks_;
  SynapticWatch synaptic_;
  PeisWatch peis_;
  InterfaceWatch interfaces_;
  // Of base stations whose log shows what their calls of set_island_id returned.
  std::map<std::uint16_t, std::uint16_t> asked_island_;

  std::map<std::uint16_t, std::uint16_t> own_island_;
  std::vector<std::int64_t> on_air_us_;  // The last frame of each device by radio; -1: none.
  std::set<std::uint16_t> cut_short_;    // Senders of net_msg under 114 bytes on a serial line.
  std::uint64_t frames_ = 0;
};

}  // namespace rubric::check
