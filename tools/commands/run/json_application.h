// An application as JSON lines: calls come in, events go out, by the names of .rtr.
#pragma once

#include <memory>
#include <string>

#include "tools/commands/run/application.h"
#include "tools/commands/run/line_output.h"
#include "tools/commands/run/line_splitter.h"

namespace rubric::run {

/// Returns an event or a call's result as a line of JSON, without its end. `node`, unless it is
/// empty, comes first.
std::string json_line(const machine::Notice& notice, const std::string& node);

/// Writes events, each at once if it can be, and makes the calls that it reads from another,
/// such as {"call":"send","dest":"11:1","app_id":10,"reliable":true,"data":"0102"}. Of a line that
/// makes no sense it writes why.
class JsonApplication final : public Application {
 public:
  struct Ends {
    int in = -1;  ///< -1: no calls come. Its end ends the node.
    std::shared_ptr<LineOutput> out;
    std::string node;  ///< Written with each event; empty: it is not.
    /// Others write to `out`, too, so that this application does not finish it.
    bool shared = false;
  };
  explicit JsonApplication(Ends ends) : ends_(std::move(ends)), input_(kLineMax) {}

  void happened(const machine::Notice& notice, Caller& caller) override;
  lines::SteadyTime run(Caller& caller) override;
  int fd() const override { return ended() ? -1 : ends_.in; }
  bool ended() const override { return ended_ || ends_.out->error() != 0; }
  void stop(Caller& caller) override;

 private:
  static constexpr std::size_t kLineMax = 65'536;

  void read(Caller& caller);
  void call(const std::string& line, Caller& caller);
  void print_error(const std::string& text);
  void print(const std::string& line) { ends_.out->put(line + '\n'); }

  Ends ends_;
  LineSplitter input_;
  bool ended_ = false;
};

}  // namespace rubric::run
