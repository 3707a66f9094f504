// A real node that is visible only through its serial line, in real time.
//
// A node cannot be restarted through its line. Instead reset does this:
// - where the attachment says `restart`, the connection of an earlier case is closed, and the node
//   has to connect again: for a base station that a script restarts;
// - the line is opened if it is not;
// - a sink is sent another island and then that of the case, which makes it forget its members
//   (N9);
// - after a line was opened, the node is awaited, for 3 s at most: a base station tells its sink
//   the island, and a sink confirms a reliable message, which is sent again every 500 ms;
// - input is dropped until nothing comes for 60 ms, and what was given last cannot be answered any
//   more (decision 125).
// All else stays as the case before left it: sequence numbers, awaited acks, channels. The id of a
// sink must be 1, and a base station's island that of the cases, 11.
//
// The rules of a mote are about its radio. Its serial line cannot break them, whatever comes there
// (debug output, say), so none of it is shown; but a broken line is noticed.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "codec/lines/packet_line.h"
#include "conformance/test/targets/rct_attachment.h"
#include "conformance/test/targets/rct_target.h"

namespace rubric::targets {

// The second channel to a node at its line: a program that speaks rct/1 for what the line does not
// show, such as the calls and news of its application (PORTING.md).

/// One node of one case. All but the accessors may throw runner::TargetBroken and
/// runner::Unsupported. Times of outputs are the program's, and mean nothing to the line.
class AppChannel {
 public:
  AppChannel(std::unique_ptr<RctClient> client, RctTarget::GiveBack give_back)
      : client_(std::move(client)), give_back_(std::move(give_back)) {}
  ~AppChannel() { give_back_(std::move(client_)); }
  AppChannel(const AppChannel&) = delete;
  AppChannel& operator=(const AppChannel&) = delete;

  /// Returns the links that it shows.
  runner::Reach shown() const;
  /// Starts the node, if the program can, and returns when it has said so.
  /// `own` is what the node states.
  void reset(const machine::Config& config, const trace::Statement& own);
  /// Gives an event and returns what the program says then.
  std::vector<Output> give(const machine::Event& event);
  /// Returns what has happened since.
  std::vector<Output> poll();

 private:
  std::vector<Output> ask(std::string command, bool passes_time);

  std::unique_ptr<RctClient> client_;
  RctTarget::GiveBack give_back_;
  Ticks now_ = 0;  // By the program's clock.
};

/// The node on a line, and its distance.
struct LineNode {
  Identity identity;         ///< With the one role that it plays.
  bool comes_to_us = false;  ///< It opens the connection, when it has started.
  bool restarts = false;     ///< It connects anew, and is new then, when its connection closes.
  std::uint32_t baud = 115200;
};

/// The line of a node, for one case after the other.
struct NodeLine {
  /// Opens it, if it is not open. Waits for a node that starts and then connects by itself.
  void open();

  std::unique_ptr<lines::PacketLine> line;
  LineNode node;
  Options options;
  bool opened = false;           ///< Once, at least.
  bool absent = false;           ///< The node did not come when it was last awaited.
  bool is_new = false;           ///< It was opened, and the node has not been awaited since.
  bool asked = false;            ///< A case began.
  bool told = false;             ///< A base station told its sink the island of a case.
  lines::SteadyTime last_given;  ///< In any case.
  std::string notes;
  std::vector<Mishap> mishaps;
};

class LineTarget : public runner::Target {
 public:
  /// `line` must outlive it. `app` may be null.
  LineTarget(NodeLine& line, std::unique_ptr<AppChannel> app) : line_(line), app_(std::move(app)) {}

  void reset(const machine::Config& config) override;
  void give(runner::Ticks now, const machine::Event& event) override;
  std::optional<runner::Ticks> next() const override;
  runner::Ticks run_until(runner::Ticks time) override;
  const std::vector<runner::Output>& outputs() const override { return outputs_; }
  void hold_link_acks(bool) override {}
  runner::Reach reach() const override {
    const runner::Reach app = app_ ? app_->shown() : runner::Reach{false, false, false, false};
    const bool has_radio = role() != machine::Role::kBaseStation;
    return {!has_radio, !is_mote(), app.peis, app.app};
  }
  /// Returns the tolerance of this host, as it was during the case, plus the time of a stimulus and
  /// its answer on the serial line.
  runner::Tolerance tolerance() const override;
  std::optional<runner::Window> given() const override { return given_; }
  std::string take_damage() override { return line_.line->take_damage(); }

 private:
  machine::Role role() const { return line_.node.identity.roles.front(); }
  bool is_mote() const { return role() == machine::Role::kMote; }
  void send(const machine::Frame& frame);
  void expect_built(const machine::Config& config) const;
  void set_island(const machine::Config& config);
  void ask_for_ack(const machine::Config& config);
  void await_node(const machine::Config& config);
  void note_island(const trace::AmFrame& frame);
  void wait_until_quiet();
  bool take(const lines::TimedPacket& packet);
  bool take(std::vector<Output> outputs);
  lines::SteadyTime step_deadline() const;

  NodeLine& line_;
  std::unique_ptr<AppChannel> app_;
  RealClock clock_;
  std::vector<runner::Output> outputs_;
  std::uint16_t island_ = 0;  // Of the case.
  runner::Ticks now_ = 0;
  std::optional<runner::Window> given_;
  const DelayWatch delays_;
};

class LineAttachment : public Attachment {
 public:
  LineAttachment(std::unique_ptr<lines::PacketLine> line, LineNode node, const Options& options);

  const Identity& identity() override;
  /// Returns one target at a time; throws runner::Unsupported if a case has several nodes.
  std::unique_ptr<runner::Target> target() override;
  std::string honesty() override { return app_ ? app_->honesty() : std::string(); }
  std::string take_stderr() override;
  std::vector<Mishap> take_mishaps() override;
  void finish() override;

 private:
  NodeLine line_;
  std::optional<RctAttachment> app_;
  bool used_ = false;
  std::weak_ptr<int> in_use_;  // Held by the target in use.
};

}  // namespace rubric::targets
