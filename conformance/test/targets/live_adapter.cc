// The reference machine behind rct/1 in real time, for tests: all of it, or a base station whose
// serial line is at a forwarder, so that only its application and PEIS are shown here.
//
//   live_adapter LATE BURST START_MS FLAW [PORT]      FLAW: none, overacking, or one of the
//   machine's
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "codec/lines/forwarder.h"
#include "conformance/machine/flaws/flaws.h"
#include "conformance/test/targets/overacking.h"
#include "conformance/test/targets/real_node.h"
#include "conformance/test/targets/serve.h"

namespace rubric::targets {
namespace {

constexpr lines::Milliseconds kNap{1};

std::unique_ptr<runner::Subject> subject_of(const std::string& flaw) {
  if (flaw == "none") return std::make_unique<runner::Machine>();
  if (flaw == "overacking") return std::make_unique<Overacking>();
  return std::make_unique<runner::Machine>(flaws::find(flaw)->step);
}

// The common part of both targets: outputs come by themselves, and are shown on request.
class RealTarget : public runner::Target {
 public:
  std::optional<runner::Ticks> next() const override { return std::nullopt; }
  runner::Ticks run_until(runner::Ticks time) override {
    const std::size_t before = outputs_.size();
    collect();
    while (outputs_.size() == before && clock_.now() < time) {
      std::this_thread::sleep_for(kNap);
      collect();
    }
    return clock_.now();
  }
  const std::vector<runner::Output>& outputs() const override { return outputs_; }
  void hold_link_acks(bool) override {}
  std::optional<runner::Window> given() const override { return given_; }

 protected:
  virtual void collect() = 0;
  void begin() {
    outputs_.clear();
    clock_.start();
  }
  void keep(runner::Output output) {
    output.time = clock_.now();
    outputs_.push_back(std::move(output));
  }
  void end_give() {
    collect();
    given_ = {clock_.now(), clock_.now()};
  }

 private:
  RealClock clock_;
  std::vector<runner::Output> outputs_;
  runner::Window given_;
};

class WholeNode : public RealTarget {
 public:
  WholeNode(std::unique_ptr<runner::Subject> subject, const Pace& pace)
      : start_(pace.start), node_(std::move(subject), pace) {
    node_.holds_link_acks = true;
    node_.tells_island = false;  // A case does not begin with it.
  }
  void reset(const machine::Config& config) override {
    std::this_thread::sleep_for(start_);
    node_.start(config);
    begin();
  }
  void give(runner::Ticks, const machine::Event& event) override {
    node_.give(event);
    end_give();
  }

 private:
  void collect() override {
    while (auto output = node_.take()) keep(std::move(*output));
  }

  const lines::Milliseconds start_;
  PacedNode node_;
};

class NodeBehindItsLine : public RealTarget {
 public:
  NodeBehindItsLine(std::string flaw, const Pace& pace, std::uint16_t port)
      : flaw_(std::move(flaw)), pace_(pace), port_(port) {}
  void reset(const machine::Config& config) override {
    node_.reset();
    auto line = std::make_unique<lines::ForwarderLine>([this](lines::SteadyTime by) {
      return lines::connect_tcp({"127.0.0.1", port_}, by);
    });
    node_ = std::make_unique<RealNode>(std::move(line), config, subject_of(flaw_), pace_, 1);
    begin();
  }
  void give(runner::Ticks, const machine::Event& event) override {
    if (const auto* const heard = std::get_if<machine::Heard>(&event)) {
      if (heard->frame.link != machine::Link::kPeis)
        throw runner::Unsupported("its line is not here");
    }
    node_->give(event);
    end_give();
  }

 private:
  void collect() override {
    for (runner::Output& output : node_->take_others()) keep(std::move(output));
  }

  const std::string flaw_;
  const Pace pace_;
  const std::uint16_t port_;
  std::unique_ptr<RealNode> node_;
};

int run(int argc, char** argv) {
  if (argc < 5) return 64;
  const auto number = [&](int i) { return static_cast<std::uint32_t>(std::atoi(argv[i])); };
  const Pace pace{number(1), number(2), lines::Milliseconds(number(3))};
  Identity identity = machine_identity();
  identity.name = "live_machine";
  identity.real_time = true;
  if (argc == 5) {
    WholeNode node(subject_of(argv[4]), pace);
    return serve(node, identity, stdin, stdout);
  }
  identity.roles = {machine::Role::kBaseStation};
  identity.shown = runner::Reach{false, false, true, true};
  NodeBehindItsLine node(argv[4], pace, static_cast<std::uint16_t>(number(5)));
  return serve(node, identity, stdin, stdout);
}

}  // namespace
}  // namespace rubric::targets

int main(int argc, char** argv) { return rubric::targets::run(argc, argv); }
