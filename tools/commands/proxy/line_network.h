// A network of switches and lamps at a TCP port, by lines of words: it stands for KNX, whose
// middleware the paper's proxy reaches by TCP.
//
//   from it:  there 1/1/7 switch            a device, its sensors, then its actuators after a dash:
//             there 1/1/8 state - lamp
//             value 1/1/7 switch 1          a reading
//             gone 1/1/7
//   to it:    watch 1/1/7 500 switch        readings every 500 ms from now on; 0: none
//             command 1/1/8 on
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "codec/lines/stream.h"
#include "tools/commands/proxy/network.h"
#include "tools/commands/run/line_splitter.h"
#include "tools/commands/run/refusals.h"

namespace rubric::proxy {

/// Connects, and connects again when the line is gone; its devices have left then. What it says is
/// foreign: a line that makes no sense is refused, with a line on stderr.
class LineNetwork final : public Network {
 public:
  LineNetwork(lines::HostPort at, Above& above);

  const char* name() const override { return "lines"; }
  void sample(const std::string& device, const Sampling& wanted) override;
  std::string command(const std::string& device, const std::string& text,
                      std::uint64_t number) override;
  int fd() const override { return stream_.fd(); }
  lines::SteadyTime run() override;

 private:
  static constexpr std::size_t kLineMax = 2048;

  void take(std::string_view line);
  void leave(const std::string& device);
  void write(const std::string& line);
  void lost(const char* why);

  lines::HostPort at_;
  Above& above_;
  lines::ByteStream stream_;
  run::LineSplitter input_{kLineMax};
  run::Refusals refusals_;
  std::set<std::string> devices_;
  lines::SteadyTime next_try_{};
  bool said_ = false;
};

}  // namespace rubric::proxy
