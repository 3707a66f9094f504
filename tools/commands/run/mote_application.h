// What a mote without an application of its own does: joins, and with the demo sends readings.
#pragma once

#include <cstdint>

#include "tools/commands/run/application.h"

namespace rubric::run {

/// Joins, and again a second after a refusal. The demo then sends readings of its sensors to the
/// PC of its island, in messages `updates`: every second, until `read_updates` asks for others. Its
/// values are slow waves; the temperature is one in a telosb's raw unit.
class MoteApplication final : public Application {
 public:
  MoteApplication(const machine::Descriptor& descriptor, bool demo)
      : descriptor_(descriptor), demo_(demo), transducers_(descriptor.transducers) {}

  void start(Caller& caller) override { caller.call(machine::JoinIsland{descriptor_}); }
  void happened(const machine::Notice& notice, Caller& caller) override;
  lines::SteadyTime run(Caller& caller) override;

 private:
  void asked(Bytes data);
  void send(Caller& caller);

  machine::Descriptor descriptor_;
  bool demo_;
  std::uint16_t transducers_;
  lines::Milliseconds period_{1000};  // 0: it is asked for none.
  bool joined_ = false;
  std::uint32_t sent_ = 0;
  lines::SteadyTime join_at_ = lines::SteadyTime::max();
  lines::SteadyTime send_at_ = lines::SteadyTime::max();
};

}  // namespace rubric::run
