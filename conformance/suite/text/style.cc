#include "conformance/suite/text/style.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "conformance/report/text.h"

namespace rubric::suite {

using report::wrapped;
using runner::CaseVerdict;

namespace {

constexpr std::size_t kErrorLines = 12;

}  // namespace

std::string painted(const TextOptions& options, std::string_view style, std::string_view text) {
  return options.color ? fmt::format("\033[{}m{}\033[0m", style, text) : std::string(text);
}

std::string_view style_of(CaseVerdict verdict, bool unexpected) {
  switch (verdict) {
    case CaseVerdict::kPass: return unexpected ? "1;31" : "32";
    case CaseVerdict::kWeak: return "33";
    case CaseVerdict::kInconclusive: return "35";
    case CaseVerdict::kFail: return unexpected ? "1;31" : "33";
    case CaseVerdict::kError: return "1;31";
    case CaseVerdict::kSkip: return "2";
  }
  return "0";
}

std::string in_capitals(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return static_cast<char>(c >= 'a' && c <= 'z' ? c - 32 : c); });
  return out;
}

std::string styled(const TextOptions& options, std::string_view style, const std::string& head,
                   const std::string& rest) {
  const std::string lines = wrapped("", head + " " + rest, options.width, kIndent.size());
  return painted(options, style, head) + lines.substr(head.size());
}

std::string field(std::string_view name, std::string_view text, const TextOptions& options) {
  if (text.empty()) return {};
  return wrapped(fmt::format("{}{:<9} ", kIndent, name), text, options.width);
}

std::string error_text(const std::string& text, const TextOptions& options) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  const std::size_t all = lines.size();
  if (all == 0) return {};
  const std::size_t first = options.verbose || all <= kErrorLines ? 0 : all - kErrorLines;
  std::string out = fmt::format("{}Its standard error{}:\n", kIndent,
                                first > 0 ? fmt::format(", last {} of {} lines", kErrorLines, all)
                                          : std::string());
  for (std::size_t i = first; i < all; ++i) {
    std::string shown;  // Controls could change the terminal.
    for (const char c : lines[i]) shown += c == '\t' || (c >= ' ' && c != 127) || c < 0 ? c : '?';
    out += fmt::format("{}  | {}\n", kIndent, shown);
  }
  return out;
}

}  // namespace rubric::suite
