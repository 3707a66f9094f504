#include <stdexcept>

#include <fmt/format.h>

#include "conformance/attach/rct_attachment.h"
#include "conformance/runner/subject_target.h"

namespace rubric::attach {
namespace {

/// The reference machine in this process.
class MachineAttachment : public Attachment {
 public:
  const Identity& identity() override { return identity_; }
  std::unique_ptr<runner::Target> target() override {
    return std::make_unique<runner::SubjectTarget>(std::make_unique<runner::Machine>());
  }
  std::string honesty() override { return {}; }
  std::string take_stderr() override { return {}; }

 private:
  const Identity identity_ = machine_identity();
};

}  // namespace

Identity machine_identity() {
  return {"rubric_machine", "1",
          {machine::Role::kMote, machine::Role::kSink, machine::Role::kBaseStation}, false};
}

std::unique_ptr<Attachment> attach(const std::string& target, const Options& options) {
  if (target.empty()) throw std::invalid_argument("a target has a name or is a command");
  if (target == "machine") return std::make_unique<MachineAttachment>();
  return std::make_unique<RctAttachment>([target] { return Process::run(target); }, options);
}

}  // namespace rubric::attach
