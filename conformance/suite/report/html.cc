#include "conformance/suite/report/html.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "conformance/suite/report/case_files.h"
#include "conformance/suite/report/html_assets.h"
#include "conformance/suite/report/html_data.h"
#include "conformance/suite/report/words.h"

namespace rubric::suite {
namespace {

namespace fs = std::filesystem;

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw std::runtime_error(path.string() + ": " + error.message());
}

void write(const fs::path& path, std::string_view text) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out) throw std::runtime_error(path.string() + ": cannot be written");
}

// Names of folders and files, each once, even where capitals do not count.
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

std::vector<CaseLinks> write_cases(const ImplementationRun& run, const fs::path& folder,
                                   const std::string& link) {
  if (!run.cases.empty()) make_folder(folder);
  Names names;
  std::vector<CaseLinks> out;
  for (const CaseRun& one : run.cases) {
    CaseLinks& links = out.emplace_back();
    if (one.result.log.lines().empty()) continue;  // Nothing was given to it.
    const std::string name = names.unique(case_name(one));
    write(folder / (name + ".rtr"), case_rtr(one));
    links.rtr = link + name + ".rtr";
    const std::string capture = case_pcapng(one);
    if (capture.empty()) continue;
    write(folder / (name + ".pcapng"), capture);
    links.pcapng = link + name + ".pcapng";
  }
  return out;
}

// Only what knows it may run in the page.
std::string random_nonce() {
  std::random_device device;
  std::string out;
  for (int i = 0; i < 4; ++i) out += fmt::format("{:08x}", device());
  return out;
}

// Each hole once: what fills one is never looked at again.
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

void write_html_report(const SuiteRun& run, const EarlierRun* earlier, const fs::path& folder) {
  make_folder(folder);
  Names names;
  std::vector<std::vector<CaseLinks>> links;
  for (std::size_t i = 0; i < run.implementations.size(); ++i) {
    const std::string name = names.unique(implementation_name(run, i));
    links.push_back(write_cases(run.implementations[i], folder / "cases" / name,
                                "cases/" + name + "/"));
  }
  const std::string nonce = random_nonce();
  const std::string data = html_data(run, earlier, links);
  write(folder / "index.html", filled(kPage, {nonce, kStyle, data, kScript}));
}

}  // namespace rubric::suite
