#include "tools/player.h"

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "conformance/trace/print.h"

namespace rubric::tools {

AttachedPlayer::AttachedPlayer(const std::string& target, double timeout_seconds,
                               std::string profile)
    : profile_(std::move(profile)) {
  attach::Options options;
  options.step_timeout = std::chrono::milliseconds(static_cast<int>(timeout_seconds * 1000));
  attachment_ = attach::attach(target, options);
  if (const std::string wrong = attachment_->honesty(); !wrong.empty()) {
    throw runner::TargetBroken(target + ": " + wrong);
  }
}

shrink::Player AttachedPlayer::player() {
  return {[this](const trace::NodeHeader&) { return attachment_->target(); }, profile_};
}

std::string AttachedPlayer::name() {
  const attach::Identity& identity = attachment_->identity();
  std::string out = identity.name;
  if (!identity.version.empty()) out += " " + identity.version;
  if (!profile_.empty()) out += " (profile " + profile_ + ")";
  return out;
}

std::string outcome_text(const runner::CaseResult& result) {
  const std::string_view verdict = runner::verdict_text(result.verdict);
  if (result.failures.empty()) {
    return result.reason.empty() ? std::string(verdict) : fmt::format("{}: {}", verdict,
                                                                      result.reason);
  }
  const runner::Failure& first = result.failures.front();
  return fmt::format("{}: {}{}{}", verdict, fmt::join(first.requirements, " "),
                     first.requirements.empty() ? "" : ": ", first.text);
}

std::string shrunk_text(const shrink::Shrunk& shrunk, const std::string& name,
                        const std::vector<std::string>& comments) {
  trace::File file = shrunk.file;
  trace::Case& one = file.cases.at(0);
  one.name = name;
  std::vector<trace::Item> items;
  for (const std::string& text : comments) {
    std::string line = text;
    for (char& c : line) {
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    }
    items.push_back(trace::Comment{';', false, " " + line});
  }
  one.items.insert(one.items.begin(), items.begin(), items.end());
  return trace::print(file);
}

}  // namespace rubric::tools
