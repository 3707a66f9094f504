#include "conformance/test/report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "conformance/report/sequence_svg.h"
#include "conformance/test/report/case_files.h"
#include "conformance/test/report/folder.h"
#include "conformance/test/report/html_assets.h"
#include "conformance/test/report/words.h"

namespace rubric::suite {
namespace {

// Makes names of folders and files unique, even where capitals do not count.
class Names {
 public:
  std::string unique(const std::string& wanted) {
    const std::string base = safe_name(wanted);
    std::string name = base;
    for (std::size_t k = 2; !taken_.insert(lower(name)).second; ++k) {
      name = fmt::format("{}~{}", base, k);
    }
    return name;
  }

 private:
  static std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
  }
  std::set<std::string> taken_;
};

// Writes the files of cases; `place` ends with '/'.
std::vector<CaseLinks> write_cases(const ImplementationRun& run, ReportFolder& folder,
                                   const std::string& place) {
  Names names;
  std::vector<CaseLinks> out;
  for (const CaseRun& one : run.cases) {
    CaseLinks& links = out.emplace_back();
    if (one.result.log.empty()) continue;  // Nothing was given to it.
    const std::string name = names.unique(case_name(one));
    links.rtr = place + name + ".rtr";
    folder.write(links.rtr, case_rtr(one));
    const std::string capture = case_pcapng(one);
    if (capture.empty()) continue;
    links.pcapng = place + name + ".pcapng";
    folder.write(links.pcapng, capture);
  }
  return out;
}

// Returns a nonce that page text cannot guess, without which no script runs.
std::string random_nonce() {
  std::random_device device;
  std::string out;
  for (int i = 0; i < 4; ++i) out += fmt::format("{:08x}", device());
  return out;
}

// Fills each placeholder once; inserted text is not searched again.
std::string filled(std::string_view page, const std::vector<std::string_view>& values) {
  static constexpr std::string_view kHoles[] = {"@NONCE@", "@STYLE@", "@DATA@", "@SCRIPT@"};
  std::string out;
  while (!page.empty()) {
    std::size_t i = 0;
    while (i < std::size(kHoles) && !page.starts_with(kHoles[i])) ++i;
    if (i < std::size(kHoles)) {
      out += values[i];
      page.remove_prefix(kHoles[i].size());
    } else {
      const std::size_t next = std::min(page.find('@', 1), page.size());
      out += page.substr(0, next);
      page.remove_prefix(next);
    }
  }
  return out;
}

}  // namespace

void write_html_report(const SuiteRun& run, const EarlierRun* earlier, ReportFolder& folder) {
  Names names;
  std::vector<std::vector<CaseLinks>> links;
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    const std::string name = names.unique(implementation_name(run, i));
    links.push_back(write_cases(run.implementations[i], folder,
                                fmt::format("{}/{}/", ReportFolder::kCases, name)));
  }
  const std::string nonce = random_nonce();
  const std::string data = html_data(run, earlier, links);
  const std::string style = fmt::format("{}\n{}", report::kSequenceStyle, kStyle);
  folder.write(ReportFolder::kPage, filled(kPage, {nonce, style, data, kScript}));
}

}  // namespace rubric::suite
