// Judges what synaptic data hold and, by an application's log, whether its channels say so.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "conformance/check/judge/context.h"
#include "conformance/machine/synaptic.h"

namespace rubric::check {

class SynapticWatch {
 public:
  SynapticWatch(Context& context, std::size_t devices);

  void begin_life(std::uint16_t node);
  /// Takes an operation on channels that the application of `node`, whose address is `own`, calls.
  void called(std::uint16_t node, const Observation& seen, machine::Address own);
  /// Notes that the mote has joined; until then it sends nothing.
  void member(std::uint16_t node, std::int64_t now_us);
  /// Notes that one of its interfaces is switched on or off.
  void able(std::uint16_t node, const machine::SetInterface& set, std::int64_t now_us);
  /// Notes that by a log it was given a message, whether that was for it or not.
  void heard(std::uint16_t node, const Observation& seen, const Net& net);
  /// Notes that by a log it was given a message for itself; not `sure`: as its radio went off.
  void given(std::uint16_t node, const Observation& seen, const Net& net, bool sure = true);
  /// Notes that by a log whose start is known data came that are surely for the node, at its
  /// address.
  void owed(std::uint16_t node, const Observation& seen, const Net& net);
  /// Judges synData_received.
  void told(std::uint16_t node, const Observation& seen, const machine::SynDataReceived& data);
  /// Judges what a call returned, by a log that has all of the node.
  void told(std::uint16_t node, const Observation& seen, const machine::Notice& result);
  /// Judges what the node owes until now, by its log.
  void settle(std::uint16_t node, std::int64_t now_us);
  void finish();
  /// Judges synaptic data, a sound net_msg, that `node` sends.
  void sent(std::uint16_t node, const Observation& seen, const Net& net);
  /// Takes the link's own repetition of a frame of the node: what it sends next had to wait for it.
  void repeated(std::uint16_t node, std::int64_t now_us);

 private:
  static constexpr std::size_t kChannelsMax = 16;
  static constexpr std::size_t kOldsMax = 64;
  static constexpr std::size_t kTickCrowd = 2;  ///< So many frames may have filled a buffer.

  /// Times at which a channel did something, newest last; shows the grid of the clock's ticks.
  struct Ticks {
    std::array<std::int64_t, 4> at_us{};
    std::uint8_t count = 0;
    void add(std::int64_t now_us);
  };
  struct Out {
    machine::ChannelId id = 0;
    bool local = false;                          ///< To the node itself.
    machine::Link line = machine::Link::kRadio;  ///< By which its data leave.
    std::int64_t begun_us = -1;                  ///< Running since; -1: it does not run.
    std::int64_t wrote_us = -1;                  ///< A value that is to be sent.
    std::int64_t waits_us = -1;                  ///< Silence counts from here.
    Ticks ticks;
    std::int64_t sent_us = -1;     ///< The last data; -1: none since it was started.
    std::int64_t tick_us = -1;     ///< When the data of their tick began to leave.
    std::int64_t written_us = -1;  ///< The last write that changed something.
    std::uint32_t written = 0;     ///< Bit i: connection i was written.
    std::array<std::uint32_t, machine::kConnectionsMax> sent_bits{};  ///< The last data.
    bool newest = false;          ///< They surely had every write before them.
    bool owes = false;            ///< Later ones were due, and are said to be missing.
    std::int64_t silent_us = -1;  ///< When it was stopped or disposed; -1: it runs.
    bool disposed = false;
    struct Old {
      std::int64_t until_us = 0;
      std::size_t pos = 0;
      std::uint32_t bits = 0;
      bool unwritten = false;  ///< No application had written it: it is free.
    };
    std::vector<Old> olds;                    ///< Values before those that were written last.
    std::int64_t forgot_us = -1'000'000'000;  ///< Older ones are not kept.
  };
  struct In {
    machine::ChannelId id = 0;
    machine::Address peer;
    bool local = false;          ///< From the node itself.
    std::int64_t begun_us = -1;  ///< Running since; -1: it does not run.
    std::int64_t ended_us = -1;  ///< Stopped or disposed, or created and not started, then.
    std::int64_t told_us = -1;   ///< The last synData_received.
    std::int64_t waits_us = -1;  ///< Silence counts from here.
    std::int64_t known_us = -1;  ///< Data that came before then have been judged.
    std::array<std::int64_t, 4> data_us{-1, -1, -1, -1};  ///< The last data that it was given.
    std::array<bool, 4> data_sure{};  ///< Whether they surely came in, from its peer.
    std::array<bool, 4> data_its{};   ///< Whether they may be from its peer.
    std::uint8_t data_next = 0;
    bool before = false;  ///< Data came while it did not run; it may count, or not.
    Ticks ticks;
    /// Data that came, oldest first, without those that surely were overwritten.
    struct Came {
      std::int64_t time_us = 0;
      std::uint16_t seq_num = 0;
      bool sure = false;  ///< They surely came in, and from its peer.
      std::vector<std::uint32_t> bits;
    };
    std::vector<Came> came;
    std::int64_t unknown_us = 0;  ///< What the channel held then is not known.
    std::uint8_t size = 0;
    void forget(std::int64_t now_us) {
      came.clear();
      unknown_us = now_us;
    }
  };
  /// Data for a channel that does not exist, which the application was not told of yet.
  struct Unknown {
    machine::ChannelId id = 0;
    Place place;
    std::uint16_t seq_num = 0;
    machine::Link link = machine::Link::kRadio;
    bool told = false;
  };
  /// Data of which the application has not been told that no channel exists for them.
  struct Heard {
    machine::ChannelId id = 0;
    std::int64_t at_us = 0;
  };
  /// What a call has to return, and why.
  struct Wanted {
    machine::Notice result;
    ReqId rule = ReqId::kNone;
    Place called;
    std::optional<machine::ReadInput> read{};
  };
  /// What a call that is refused after all has not changed.
  struct Former {
    machine::Synaptic channels;
    std::vector<In> ins;
    std::vector<Out> outs;
    std::int64_t restart_us = -1;
    bool shifted = false;
  };
  struct Node {
    std::vector<Unknown> unknowns;
    std::vector<Heard> heard;
    bool forgot_heard = false;                ///< There were more.
    std::vector<machine::ChannelId> perhaps;  ///< Calls that the model refused; who knows.
    std::vector<machine::ChannelId> twins;    ///< Two channels, to peers in two islands.
    std::int64_t data_us = -1;                ///< The last data of any channel.
    std::int64_t tick_us = -1;                ///< When those of their tick began to leave.
    bool logged = false;                      ///< Its log has the calls that create channels.
    machine::Address own{kNoIsland, 0};       ///< As known at the last call.
    std::int64_t settled_us = -1;             ///< What was owed until then is judged.
    std::int64_t member_us = -1;              ///< A mote: joined since; a sink always is.
    std::int64_t on_us = 0;                   ///< Its radio is on since; -1: it is off.
    std::int64_t serial_on_us = 0;            ///< And its serial line.
    std::int64_t restart_us = -1;             ///< A channel was started while others ran.
    bool shifted = false;                     ///< That shifted the ticks, and was reported.
    std::vector<In> ins;
    machine::Synaptic channels;
    std::vector<Wanted> wanted;      ///< Of calls that have not returned; in order.
    std::unique_ptr<Former> former;  ///< What there was before the last call, if there was one.
    std::int64_t step_us = -1;       ///< The last set_time_step.
    std::uint32_t former_ticks = 0;  ///< The period before it, which a tick may end first.
    std::vector<Out> outs;
  };

  Out* find(Node& node, machine::ChannelId id);
  machine::ChannelId input_id(std::uint16_t device, const Net& net) const;
  static In* find_in(Node& node, machine::ChannelId id);
  static bool is_twin(const Node& node, machine::ChannelId id);
  static bool may_be_local(machine::ChannelId id);
  void refused(std::uint16_t device, const Observation& seen, const Wanted& wanted);
  bool overwritten(std::uint16_t device, const In& in, std::int64_t time_us, std::size_t pos,
                   std::int64_t until_us) const;
  void keep_values(std::uint16_t device, In& in, const Observation& seen, const Net& net,
                   bool sure);
  void judge_value(std::uint16_t device, const Observation& seen, const Wanted& wanted,
                   float value);
  void judge_untold(std::uint16_t device, std::int64_t now_us);
  void told_of_unknown(std::uint16_t device, const Observation& seen, machine::ChannelId id);
  void told_of_nothing(std::uint16_t device, const Observation& seen, machine::ChannelId id);
  bool flooded(std::uint16_t device, const Unknown& one) const;
  void note_inputs(Node& node, const machine::Synaptic& before, std::int64_t now_us);
  void begin(std::uint16_t device);
  static bool is_local(const Node& node, const machine::Channel& channel);
  bool news_of_nothing(std::uint16_t device, const In& in);
  bool always_news(Node& node, const In& in);
  std::int64_t able_since(std::uint16_t device, std::int64_t now_us,
                          std::optional<machine::Link> line, bool local = false) const;
  std::int64_t patience_us(std::uint16_t device, bool first, std::int64_t last_us) const;
  void settle_at(std::uint16_t device, std::int64_t now_us);
  void settle_unknowns(std::uint16_t device, std::int64_t now_us);
  void settle_outputs(std::uint16_t device, std::int64_t now_us);
  bool crowded(std::uint16_t device, std::int64_t from_us, std::int64_t to_us) const;
  bool left_out(std::uint16_t device, const Ticks& ticks, std::int64_t runs_us) const;
  Severity unsent(std::uint16_t device, std::int64_t since_us, std::int64_t now_us) const;
  void sent_of_nothing(std::uint16_t device, const Observation& seen, const Net& net);
  void judge_content(std::uint16_t node, const Observation& seen, const Net& net);
  void judge_grid(std::uint16_t device, const Observation& seen, const Ticks& ticks);
  void judge_share(std::uint16_t device, const Observation& seen, Out& out);
  void note(Node& node, const machine::Synaptic& before, std::int64_t now_us);
  static void note_old(Out& out, const machine::Synaptic& before, std::size_t pos,
                       std::int64_t now_us);

  Context& context_;
  std::vector<Node> nodes_;
};

}  // namespace rubric::check
