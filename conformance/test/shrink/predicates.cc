#include "conformance/test/shrink/predicates.h"

#include <algorithm>
#include <utility>

#include "conformance/trace/headers.h"

namespace rubric::shrink {
namespace {

using runner::CaseResult;
using runner::CaseVerdict;

struct Candidate {
  const trace::File* file;
  const trace::Case* one;
  std::size_t lines;
};

bool broke(const CaseResult& result) { return result.verdict == CaseVerdict::kFail; }
bool kept(const CaseResult& result) {
  return result.verdict == CaseVerdict::kPass || result.verdict == CaseVerdict::kWeak;
}

// Default first numbers, 0 and 65535: see runner::config_of.
constexpr std::uint64_t kSeeds[] = {0, 58392, 58647};

bool keeps(const trace::File& file, const Player& reference) {
  return std::all_of(std::begin(kSeeds), std::end(kSeeds), [&](std::uint64_t seed) {
    trace::File asked = file;
    if (seed != 0) trace::set_header(asked, asked.cases.at(0), trace::SeedHeader{seed});
    return kept(play(asked, reference));
  });
}

bool fails_so(const CaseResult& result, const runner::Failure& wanted) {
  return std::any_of(result.failures.begin(), result.failures.end(), [&](const auto& failure) {
    return !failure.implied && failure.place.line == wanted.place.line &&
           failure.crash == wanted.crash && failure.requirements == wanted.requirements;
  });
}

}  // namespace

trace::File only(const trace::File& file, const trace::Case& one) {
  trace::File out;
  out.head = file.head;
  out.cases.push_back(one);
  return out;
}

CaseResult play(const trace::File& file, const Player& player) {
  trace::File asked = file;
  if (!player.profile.empty()) {
    trace::set_header(asked, asked.cases.at(0), trace::ProfileHeader{player.profile});
  }
  CaseResult result;
  result.reason = trace::state(asked, asked.cases.at(0), player.stated);
  if (result.reason.empty()) return runner::run_case(asked, asked.cases.at(0), player.make);
  result.verdict = CaseVerdict::kSkip;
  return result;
}

StillShows fails_alike(const CaseResult& first, const Player& player,
                       const std::vector<Player>& references) {
  const CaseVerdict verdict = first.verdict;
  runner::Failure wanted;
  for (const runner::Failure& failure : first.failures) {
    if (failure.weak && verdict == CaseVerdict::kFail) continue;
    wanted = failure;
    break;
  }
  return [=](const trace::File& file) {
    const CaseResult result = play(file, player);
    return result.verdict == verdict && fails_so(result, wanted) &&
           std::all_of(references.begin(), references.end(),
                       [&](const Player& reference) { return keeps(file, reference); });
  };
}

bool differ(const CaseResult& a, const CaseResult& b) {
  return (broke(a) && kept(b)) || (kept(a) && broke(b));
}

DifferenceSearch find_difference(const std::vector<const trace::File*>& files, const Player& a,
                                 const Player& b, std::size_t shrunk_max) {
  DifferenceSearch search;
  std::vector<Candidate> candidates;
  for (const trace::File* file : files) {
    for (const trace::Case& one : file->cases) {
      const trace::File alone = only(*file, one);
      const CaseResult of_a = play(alone, a);
      const CaseResult of_b = play(alone, b);
      const auto played = [](const CaseResult& of) { return of.verdict < CaseVerdict::kError; };
      if (!played(of_a) || !played(of_b)) {
        ++search.skipped;
        continue;
      }
      ++search.compared;
      if (!differ(of_a, of_b)) continue;
      search.different.push_back(one.name);
      candidates.push_back({file, &one, one.lines().size()});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& x, const Candidate& y) { return x.lines < y.lines; });
  candidates.resize(std::min(candidates.size(), shrunk_max));
  const StillShows shows = [&](const trace::File& file) {
    return differ(play(file, a), play(file, b));
  };
  for (const Candidate& candidate : candidates) {
    Shrunk shrunk = shrink(*candidate.file, *candidate.one, shows);
    if (shrunk.lines_before == 0) continue;  // It differed by chance.
    if (search.shortest && search.shortest->shrunk.lines <= shrunk.lines) continue;
    search.shortest = Difference{std::move(shrunk), candidate.one->name, {}, {}};
    search.shortest->a = play(search.shortest->shrunk.file, a);
    search.shortest->b = play(search.shortest->shrunk.file, b);
  }
  return search;
}

}  // namespace rubric::shrink
