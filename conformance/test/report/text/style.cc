#include "conformance/test/report/text/style.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "codec/text/text.h"

namespace rubric::suite {

using runner::CaseVerdict;

namespace {

constexpr std::size_t kErrorLines = 12;

}  // namespace

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
  std::string out = fmt::format(
      "{}Its standard error{}:\n", kIndent,
      first > 0 ? fmt::format(", last {} of {} lines", kErrorLines, all) : std::string());
  for (std::size_t i = first; i < all; ++i) {
    out += fmt::format("{}  | {}\n", kIndent, text::harmless(lines[i], text::Keep::kLines));
  }
  return out;
}

}  // namespace rubric::suite
