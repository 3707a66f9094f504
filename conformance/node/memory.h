// A node with its memory, by the sizes that a program chooses.
#pragma once

#include "conformance/node/node.h"

namespace rubric {
namespace node {

/// A node's memory besides the node itself.
template <class Sizes>
class Memory {
 protected:
  static constexpr size_t kMessages = size_t{Sizes::kRadioOut} + Sizes::kRadioIn +
                                      Sizes::kSerialOut + Sizes::kSerialIn + Sizes::kPeisOut +
                                      Sizes::kPeisIn;

  Buffers buffers() {
    return {messages_,
            {Sizes::kRadioOut, Sizes::kSerialOut, Sizes::kPeisOut},
            {Sizes::kRadioIn, Sizes::kSerialIn, Sizes::kPeisIn},
            channels_,
            Sizes::kChannels,
            awaited_,
            Sizes::kAwaited,
            admissions_,
            Sizes::kMembers};
  }

 private:
  Message messages_[kMessages];
  Channel channels_[2 * Sizes::kChannels];
  AwaitedAck awaited_[Sizes::kAwaited];
  Admission admissions_[Sizes::kMembers == 0 ? 1 : Sizes::kMembers + kOpenJoinsMax];
};

/// A node with all its memory.
template <class Sizes>
class SizedNode : private Memory<Sizes>, public Node {
 public:
  SizedNode(Driver& driver, Application& application)
      : Node(driver, application, Memory<Sizes>::buffers()) {}
};

}  // namespace node
}  // namespace rubric
