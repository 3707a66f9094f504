// A real node that is visible only through its serial line, in real time.
//
// A node cannot be restarted through its line. Instead reset does this:
// - the line is opened if it is not, and input is dropped until nothing comes for 60 ms;
// - a sink is sent another island and then that of the case, which makes it forget its members
//   (N9);
// - where the attachment says `restart`, the connection of an earlier case is closed first, and the
//   node has to connect again: for a base station that a script restarts.
// All else stays as the case before left it: sequence numbers, awaited acks, channels. The id of a
// sink must be 1, and a base station's island that of the cases, 11.
//
// The rules of a mote are about its radio. Its serial line cannot break them, whatever comes there
// (debug output, say), so none of it is shown; but a broken line is noticed.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "codec/lines/packet_line.h"
#include "conformance/test/targets/attachment.h"
#include "conformance/test/targets/clock.h"

namespace rubric::targets {

/// The node on a line, and its distance.
struct LineNode {
  Identity identity;         ///< With the one role that it plays.
  bool comes_to_us = false;  ///< It opens the connection, when it has started.
  bool restarts = false;     ///< It connects anew, and is new then, when its connection closes.
  std::uint32_t baud = 115200;
};

class LineTarget : public runner::Target {
 public:
  /// `line`, `node` and `notes` must outlive it.
  LineTarget(lines::PacketLine& line, const LineNode& node, const Options& options,
             std::string& notes)
      : line_(line), node_(node), options_(options), notes_(notes) {}

  void reset(const machine::Config& config) override;
  void give(runner::Ticks now, const machine::Event& event) override;
  std::optional<runner::Ticks> next() const override;
  runner::Ticks run_until(runner::Ticks time) override;
  const std::vector<runner::Output>& outputs() const override { return outputs_; }
  void hold_link_acks(bool) override {}
  runner::Reach reach() const override { return {false, !is_mote(), false, false}; }
  /// Returns the tolerance of this host plus the time of a stimulus and its answer on the serial
  /// line.
  runner::Tolerance tolerance() const override;

 private:
  bool is_mote() const { return node_.identity.roles.front() == machine::Role::kMote; }
  void send(const machine::Frame& frame);
  void set_island(std::uint16_t island);
  void let_settle();
  bool take(const lines::TimedPacket& packet);
  lines::SteadyTime step_deadline() const;

  lines::PacketLine& line_;
  const LineNode& node_;
  const Options options_;
  std::string& notes_;
  RealClock clock_;
  std::vector<runner::Output> outputs_;
  runner::Ticks now_ = 0;
};

class LineAttachment : public Attachment {
 public:
  LineAttachment(std::unique_ptr<lines::PacketLine> line, LineNode node, const Options& options)
      : line_(std::move(line)), node_(std::move(node)), options_(options) {}

  const Identity& identity() override;
  /// Returns one target at a time; throws runner::Unsupported if a case has several nodes.
  std::unique_ptr<runner::Target> target() override;
  std::string honesty() override { return {}; }
  std::string take_stderr() override;

 private:
  void open();

  std::unique_ptr<lines::PacketLine> line_;
  LineNode node_;
  Options options_;
  std::string notes_;
  bool opened_ = false;  // Once, at least.
  bool used_ = false;
  std::weak_ptr<int> in_use_;  // Held by the target in use.
};

}  // namespace rubric::targets
