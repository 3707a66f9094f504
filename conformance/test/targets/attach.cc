#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "codec/lines/forwarder.h"
#include "codec/lines/serial.h"
#include "conformance/machine/flaws/flaws.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/test/targets/line_target.h"
#include "conformance/test/targets/rct_attachment.h"
#include "conformance/test/targets/rct_text.h"
#include "conformance/trace/protocol.h"

namespace rubric::targets {
namespace {

using machine::Role;

constexpr std::uint32_t kForwarderBaud = 57600;  // The slower common one; not reported.
constexpr std::uint32_t kSerialBaud = 115200;

/// Reports the death of a flawed machine as that of a process.
class MachineTarget : public runner::SubjectTarget {
 public:
  using SubjectTarget::SubjectTarget;
  void give(runner::Ticks now, const machine::Event& event) override {
    try {
      SubjectTarget::give(now, event);
    } catch (const flaws::Died& death) {
      throw runner::TargetBroken(fmt::format("`{}`: {}", command_of(event, now), death.what()));
    }
  }
};

/// The reference machine in this process, perhaps with a flaw.
class MachineAttachment : public Attachment {
 public:
  MachineAttachment(const flaws::Flaw* flaw, const Options& options) : flaw_(flaw) {
    identity_.stated = options.stated;
    if (flaw) identity_.version = flaw->name;
    if (flaw && !flaw->roles.empty()) {
      identity_.roles.assign(flaw->roles.begin(), flaw->roles.end());
    }
  }
  const Identity& identity() override { return identity_; }
  std::unique_ptr<runner::Target> target() override {
    return std::make_unique<MachineTarget>(
        std::make_unique<runner::Machine>(flaw_ ? flaw_->step : machine::step));
  }
  std::string honesty() override { return {}; }
  std::string take_stderr() override { return {}; }

 private:
  const flaws::Flaw* flaw_;
  Identity identity_ = machine_identity();
};

std::unique_ptr<Attachment> flawed_machine(std::string_view name, const Options& options) {
  const flaws::Flaw* flaw = flaws::find(name);
  if (flaw) return std::make_unique<MachineAttachment>(flaw, options);
  std::vector<std::string> names;
  for (const flaws::Flaw& one : flaws::all()) names.emplace_back(one.name);
  for (const flaws::Flaw& one : flaws::whole_releases()) names.emplace_back(one.name);
  throw std::invalid_argument(
      fmt::format("the machine has no flaw '{}'; it knows {}", name, fmt::join(names, ", ")));
}

// Removes `prefix` from the text.
bool cut(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}
bool cut_end(std::string_view& text, std::string_view end) {
  if (!text.ends_with(end)) return false;
  text.remove_suffix(end.size());
  return true;
}

LineNode real_node(Role role, const char* where, std::uint32_t baud, const Options& options) {
  LineNode node;
  node.identity = {fmt::format("{}_{}", role_word(role), where), "-", {role}, true, true};
  node.identity.stated = options.stated;
  node.baud = baud;
  return node;
}

// Removes the role that may end a target that is no server.
Role cut_role(std::string_view& text) {
  if (cut_end(text, ":mote")) return Role::kMote;
  cut_end(text, ":sink");
  return Role::kSink;
}

std::unique_ptr<Attachment> forwarder_server(std::string_view text, const Options& options) {
  LineNode node = real_node(Role::kBaseStation, "at_forwarder", kForwarderBaud, options);
  node.comes_to_us = true;
  node.restarts = cut_end(text, ":restart");
  auto listener = std::make_shared<lines::Listener>(lines::read_host_port(text));
  auto line = std::make_unique<lines::ForwarderLine>(
      [listener](lines::SteadyTime deadline) { return listener->accept(deadline); });
  return std::make_unique<LineAttachment>(std::move(line), std::move(node), options);
}

std::unique_ptr<Attachment> forwarder_client(std::string_view text, const Options& options) {
  const Role role = cut_role(text);
  const lines::HostPort at = lines::read_host_port(text);
  auto line = std::make_unique<lines::ForwarderLine>(
      [at](lines::SteadyTime deadline) { return lines::connect_tcp(at, deadline); });
  return std::make_unique<LineAttachment>(
      std::move(line), real_node(role, "behind_forwarder", kForwarderBaud, options), options);
}

std::unique_ptr<Attachment> serial_line(std::string_view text, const Options& options) {
  const Role role = cut_role(text);
  std::uint32_t baud = kSerialBaud;
  lines::SerialLine::Connect connect;
  if (cut(text, "tcp:")) {
    const lines::HostPort at = lines::read_host_port(text);
    connect = [at](lines::SteadyTime deadline) { return lines::connect_tcp(at, deadline); };
  } else {
    if (const std::size_t colon = text.rfind(':'); colon != std::string_view::npos) {
      const std::string_view word = text.substr(colon + 1);
      const auto known = lines::baud_of(word);
      if (!known) throw std::invalid_argument(fmt::format("'{}' is not a speed or platform", word));
      baud = *known;
      text = text.substr(0, colon);
    }
    if (text.empty()) throw std::invalid_argument("serial: lacks its device");
    connect = [path = std::string(text), baud](lines::SteadyTime) {
      return lines::open_serial_device(path, baud);
    };
  }
  return std::make_unique<LineAttachment>(std::make_unique<lines::SerialLine>(std::move(connect)),
                                          real_node(role, "on_serial_line", baud, options),
                                          options);
}

}  // namespace

Identity machine_identity() {
  return {"rubric_machine", "1", {Role::kMote, Role::kSink, Role::kBaseStation}, false};
}

bool is_command(const std::string& target) {
  const std::string_view text = target;
  return target != "machine" && !text.starts_with("machine:") && !text.starts_with("sf:") &&
         !text.starts_with("sf-server:") && !text.starts_with("serial:");
}

std::unique_ptr<Attachment> attach(const std::string& target, const Options& options) {
  if (target.find_first_not_of(" \t\n") == std::string::npos) {
    throw std::invalid_argument("a target has a name or is a command");
  }
  std::string_view text = target;
  if (!is_command(target) && !trace::protocol().has_machine) {
    throw std::invalid_argument(
        fmt::format("the machine and nodes at their lines are for RUBICON; {} needs a command that "
                    "speaks rct/1",
                    trace::protocol().name));
  }
  if (cut(text, "sf-server:")) return forwarder_server(text, options);
  if (cut(text, "sf:")) return forwarder_client(text, options);
  if (cut(text, "serial:")) return serial_line(text, options);
  if (!options.app.empty()) throw std::invalid_argument("an app goes with sf-server, sf or serial");
  if (target == "machine") return std::make_unique<MachineAttachment>(nullptr, options);
  if (cut(text, "machine:")) return flawed_machine(text, options);
  return std::make_unique<RctAttachment>([target] { return Process::run(target); }, options);
}

}  // namespace rubric::targets
