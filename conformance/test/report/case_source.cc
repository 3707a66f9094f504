#include "conformance/test/report/case_source.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <variant>

#include "conformance/test/suite/cases.h"
#include "conformance/trace/parse.h"

namespace rubric::suite {
namespace {

std::string text_of(const std::string& name, bool own) {
  if (own) {
    for (const EmbeddedFile& file : embedded_files()) {
      if (file.name == name) return file.text;
    }
    return {};
  }
  std::ifstream in(name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

bool is_nothing(const std::string& line) {
  return line.empty() || line.front() == ';' || line.front() == '#';
}

}  // namespace

const CaseSources::Source& CaseSources::read(const std::string& name, bool own) {
  const auto [found, added] = files_.try_emplace(name);
  Source& source = found->second;
  if (!added) return source;
  const std::string text = text_of(name, own);
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.ends_with('\r')) line.pop_back();
    source.lines.push_back(line);
  }
  const trace::Parsed parsed = trace::parse_syntax(text, name);
  for (const trace::Item& item : parsed.file.head) {
    const auto* header = item.as<trace::Header>();
    if (header && header->place.line > 0) source.head.push_back(header->place.line);
  }
  for (const trace::Case& one : parsed.file.cases) source.cases[one.name] = one.place.line;
  return source;
}

std::vector<SourceLine> CaseSources::of(const SuiteRun& run, const CaseRun& one) {
  const Source& source = read(one.file, run.traces.empty());
  const auto found = source.cases.find(one.name);
  if (found == source.cases.end() || found->second == 0) return {};
  const std::uint32_t first = found->second;
  std::uint32_t end = static_cast<std::uint32_t>(source.lines.size()) + 1;
  for (const auto& [name, line] : source.cases) {
    if (line > first) end = std::min(end, line);
  }
  // Lines above the next case are about that one.
  while (end > first + 1 && is_nothing(source.lines[end - 2])) --end;
  std::vector<SourceLine> out;
  for (const std::uint32_t line : source.head) out.push_back({line, source.lines[line - 1]});
  for (std::uint32_t line = first; line < end; ++line) {
    out.push_back({line, source.lines[line - 1]});
  }
  return out;
}

}  // namespace rubric::suite
