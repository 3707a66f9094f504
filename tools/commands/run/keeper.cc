#include "tools/commands/run/keeper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "codec/text/text.h"
#include "conformance/trace/print.h"
#include "tools/commands/run/wall_clock.h"

namespace rubric::run {
namespace {

constexpr std::int64_t kWaitNs = 200'000'000;

}  // namespace

bool Keeper::open_capture(const std::string& path, Mode mode, const lines::Rotation& rotation) {
  capture_.emplace(path, mode, rotation);
  return capture_->open();
}

void Keeper::open_log(const std::string& path, Mode mode,
                      const std::vector<trace::NodeHeader>& nodes, std::uint64_t seed) {
  trace::File file = trace::File::begin("paper", trace::Tick::kUs);
  trace::Header header;
  header.what = trace::SeedHeader{seed};
  file.header(header);
  for (const trace::NodeHeader& node : nodes) file.node(node);
  file.cases.emplace_back("run");
  log_ = std::make_unique<text::OutFile>(path, mode);
  log_path_ = path;
  check_log(text::write_all(log_->fd(), trace::print(file)));
}

void Keeper::frame(const Packet& packet, std::string_view interface_name) {
  const std::lock_guard lock(mutex_);
  if (!capture_) return;
  Kept kept{.packet = packet};
  kept.bytes.assign(packet.bytes.begin(), packet.bytes.end());
  kept.interface_name = interface_name;
  const auto place = std::upper_bound(
      waiting_.begin(), waiting_.end(), packet.time_ns,
      [](std::int64_t time_ns, const Kept& other) { return time_ns < other.packet.time_ns; });
  waiting_.insert(place, std::move(kept));
  write_until(wall_ns() - kWaitNs);
}

void Keeper::settle() {
  const std::lock_guard lock(mutex_);
  if (capture_) write_until(wall_ns() - kWaitNs);
}

void Keeper::write_until(std::int64_t time_ns) {
  auto at = waiting_.begin();
  for (; at != waiting_.end() && at->packet.time_ns <= time_ns; ++at) {
    at->packet.bytes = Bytes(at->bytes.data(), at->bytes.size());
    capture_->write(at->packet, at->interface_name);
  }
  waiting_.erase(waiting_.begin(), at);
}

std::int64_t Keeper::now_us() const {
  return (std::chrono::steady_clock::now() - started_) / std::chrono::microseconds(1);
}

void Keeper::given(const events::NodeNames& names, const machine::Event& event) {
  const std::lock_guard lock(mutex_);
  if (!log_) return;
  if (const auto line = events::given_line(now_us(), names, event)) put(*line);
}

void Keeper::did(const events::NodeNames& names, const machine::Frame& frame) {
  const std::lock_guard lock(mutex_);
  if (log_) put(events::emitted_line(now_us(), names, frame, ReqId::kNone));
}

void Keeper::did(const events::NodeNames& names, const machine::Notice& notice) {
  const std::lock_guard lock(mutex_);
  if (log_) put(events::emitted_line(now_us(), names, notice, ReqId::kNone));
}

void Keeper::put(const trace::Line& line) {
  std::string text;
  trace::put_line(line, text);
  text += '\n';
  if (log_error_ == 0) check_log(text::write_all(log_->fd(), text));
}

void Keeper::check_log(int error) {
  log_error_ = error;
  if (error == 0) return;
  text::print(stderr, "rubric: cannot write {}: {}\n", log_path_, std::strerror(error));
}

bool Keeper::finish() {
  const std::lock_guard lock(mutex_);
  bool good = true;
  if (capture_) {
    write_until(INT64_MAX);
    good = capture_->finish();
  }
  if (log_) {
    const int error = log_->finish();
    if (log_error_ == 0) check_log(error);
  }
  return good && log_error_ == 0;
}

}  // namespace rubric::run
