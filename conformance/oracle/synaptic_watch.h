// Synaptic data against what an application's log says of the channels. Without a log, silent.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/machine/synaptic.h"
#include "conformance/oracle/context.h"

namespace rubric::oracle {

class SynapticWatch {
 public:
  SynapticWatch(Context& context, std::size_t devices);

  void begin_life(std::uint16_t node);
  /// The application of `node`, whose address is `own`, calls an operation of the channels.
  void called(std::uint16_t node, const Observation& seen, machine::Address own);
  /// `node` sends synaptic data, a sound net_msg.
  void sent(std::uint16_t node, const Observation& seen, const Net& net);

 private:
  static constexpr std::size_t kChannelsMax = 16;

  struct Out {
    machine::ChannelId id = 0;
    std::int64_t sent_us = -1;     ///< The last data; -1: none since it was started.
    std::int64_t written_us = -1;  ///< The last write that changed something.
    std::int64_t silent_us = -1;   ///< When it was stopped or disposed; -1: it runs.
    bool disposed = false;
  };
  struct Node {
    bool logged = false;           ///< Its log creates channels.
    machine::Synaptic channels;
    std::int64_t step_us = -1;     ///< The last set_time_step.
    std::vector<Out> outs;
  };

  Out* find(Node& node, machine::ChannelId id);
  void note(Node& node, const machine::Synaptic& before, std::int64_t now_us);

  Context& context_;
  std::vector<Node> nodes_;
};

}  // namespace rubric::oracle
