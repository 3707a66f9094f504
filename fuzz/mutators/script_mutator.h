// Mutates scripts of one node by their meaning: answers to the node's output, messages from the
// table, times at which something is due.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "codec/frame_generator/frame_generator.h"
#include "conformance/selftest/scripts/script.h"

namespace rubric::fuzz {

/// Makes mutants of scripts. The same seed and calls give the same mutants.
class ScriptMutator {
 public:
  explicit ScriptMutator(std::uint64_t seed);

  /// Makes a few changes. The script keeps the bounds of script::decode().
  void mutate(script::Script& script);
  /// Returns the beginning of one and the end of the other, or some steps of each in their order.
  script::Script cross_over(const script::Script& one, const script::Script& other);
  void reseed(std::uint64_t seed) { random() = generate::Random(seed); }

 private:
  using Frame = machine::Frame;
  // The machine's outputs before a step of the script, and the time of its next act.
  struct Moment {
    machine::Ticks now = 0;
    std::size_t outputs = 0;
    std::optional<machine::Ticks> due;
  };
  struct History {
    std::vector<Moment> before;  // For each step, and the end.
    std::vector<runner::Output> outputs;
  };
  class Recorder;

  void change(script::Script& script);
  static History history_of(const script::Script& script);
  void insert(script::Script& script);
  std::optional<script::Step> answer(const script::Script& script, const History& history,
                                     std::size_t at);
  std::optional<script::Step> answer_to(const script::Script& script,
                                        const machine::Transmit& sent);
  script::Step message(const script::Script& script, const History& history, std::size_t at);
  script::Step happening(const script::Script& script);
  void fit_message(const script::Script& script, const History& history, std::size_t at,
                   machine::Frame& frame, std::vector<std::uint8_t>& payload);
  void change_delay(script::Script& script);
  void change_field(script::Script& script);

  generate::Random& random() { return generator_.random(); }
  std::size_t below(std::size_t n) { return random().below(n); }
  bool one_in(std::size_t n) { return below(n) == 0; }

  generate::FrameGenerator generator_;
  std::vector<const reflect::Route*> routes_;  // Those that frames can take.
};

}  // namespace rubric::fuzz
