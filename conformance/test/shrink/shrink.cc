#include "conformance/test/shrink/shrink.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "conformance/trace/check.h"
#include "conformance/trace/headers.h"

namespace rubric::shrink {
namespace {

using runner::CaseResult;
using runner::CaseVerdict;
using trace::Header;
using trace::Item;
using trace::Line;
using trace::Message;
using trace::Op;

// Returns the case's lines with the headers that apply to it: no comments, no blanks.
trace::File alone(const trace::File& file, const trace::Case& one) {
  trace::File out;
  const auto has_own = [&](std::size_t kind) {
    return std::any_of(one.items.begin(), one.items.end(), [&](const Item& item) {
      const Header* header = item.as<Header>();
      return header && header->what.index() == kind;
    });
  };
  const auto take = [&](const std::vector<Item>& items, bool of_file) {
    for (const Item& item : items) {
      const Header* header = item.as<Header>();
      if (!header || std::holds_alternative<trace::NoteHeader>(header->what)) continue;
      if (of_file && has_own(header->what.index())) continue;
      out.head.push_back(Header{header->what, "", header->place});
    }
  };
  take(file.head, true);
  take(one.items, false);
  trace::Case lines(one.name);
  lines.place = one.place;
  for (const Line* line : one.lines()) {
    Line copy = *line;
    copy.comment.clear();
    lines.add(std::move(copy));
  }
  out.cases.push_back(std::move(lines));
  return out;
}

bool names_variable(const trace::Value& value) {
  const bool range_of = value.is(trace::Value::Kind::kRange) && !value.text.empty();
  return value.is(trace::Value::Kind::kVariable) || range_of ||
         std::any_of(value.items.begin(), value.items.end(), names_variable);
}

class Shrinker {
 public:
  Shrinker(trace::File file, const StillShows& still_shows)
      : file_(std::move(file)), still_shows_(still_shows) {}

  bool shows(const trace::File& candidate) {
    if (!trace::check(candidate).empty()) return false;
    ++tried_;
    return still_shows_(candidate);
  }

  void run() {
    for (std::size_t before = size() + 1; size() < before;) {
      before = size();
      drop_lines();
      drop_each_line();
    }
    simplify_lines();
    drop_headers();
  }

  const trace::File& file() const { return file_; }
  std::size_t tried() const { return tried_; }
  std::size_t size() const { return file_.cases[0].items.size(); }

 private:
  bool try_it(trace::File candidate) {
    if (!shows(candidate)) return false;
    file_ = std::move(candidate);
    return true;
  }

  trace::File without(std::size_t from, std::size_t to) const {
    trace::File out = file_;
    auto& items = out.cases[0].items;
    items.erase(items.begin() + static_cast<std::ptrdiff_t>(from),
                items.begin() + static_cast<std::ptrdiff_t>(to));
    return out;
  }

  // Tries ddmin's complements: pieces from a half down to single lines.
  void drop_lines() {
    std::size_t pieces = 2;
    while (size() >= 2 && pieces <= size()) {
      const std::size_t length = (size() + pieces - 1) / pieces;
      bool dropped = false;
      for (std::size_t from = 0; from < size() && !dropped; from += length) {
        dropped = try_it(without(from, std::min(from + length, size())));
      }
      if (dropped) {
        pieces = std::max<std::size_t>(2, pieces - 1);
      } else if (pieces == size()) {
        return;
      } else {
        pieces = std::min(size(), pieces * 2);
      }
    }
  }

  // Starts from the end, where lines that others count from have lost their successors; else these
  // count from the line that is then before them.
  void drop_each_line() {
    for (std::size_t i = size(); i-- > 0 && size() > 1;) {
      if (try_it(without(i, i + 1)) || line(i).label.empty()) continue;
      const std::string label = line(i).label;
      trace::File candidate = without(i, i + 1);
      for (Item& item : candidate.cases[0].items) {
        trace::Time& time = (*item.as<Line>()).time;
        if (time.base != trace::Time::Base::kLabel || time.label != label) continue;
        time.base = trace::Time::Base::kPrevious;
        time.label.clear();
      }
      try_it(std::move(candidate));
    }
  }

  template <class Edit>
  bool try_edit(std::size_t i, Edit edit) {
    trace::File candidate = file_;
    Line& line = (*candidate.cases[0].items[i].as<Line>());
    const Line before = line;
    edit(line);
    return !(line == before) && try_it(std::move(candidate));
  }
  const Line& line(std::size_t i) const { return (*file_.cases[0].items[i].as<Line>()); }

  void simplify_lines() {
    for (std::size_t i = 0; i < size(); ++i) {
      try_edit(i, [](Line& one) { one.label.clear(); });
      try_edit(i, [](Line& one) { one.am.reset(); });
      try_edit(i, [](Line& one) { one.bytes.reset(); });
      drop_fields(i);
      if (line(i).op == Op::kGiven) hurry(i);
    }
  }

  // Drops fields: a missing one is a wildcard in an expectation, and zero in a stimulus.
  void drop_fields(std::size_t i) {
    const bool fits = line(i).message.form == Message::Form::kFields;
    for (std::size_t f = line(i).message.fields.size(); fits && f-- > 0;) {
      try_edit(i, [f](Line& one) {
        auto& fields = one.message.fields;
        if (fields[f].path.empty()) return;  // Its place among the others is its name.
        // Zero may or may not equal the variable's value.
        if (one.op == Op::kGiven && names_variable(fields[f].value)) return;
        fields.erase(fields.begin() + static_cast<std::ptrdiff_t>(f));
        one.message.open = true;
      });
    }
  }

  // Moves a stimulus as early as possible, by bisection.
  void hurry(std::size_t i) {
    if (!line(i).time.exact()) return;
    std::int64_t low = 0;
    std::int64_t high = line(i).time.from;
    while (low < high) {
      const std::int64_t middle = low + (high - low) / 2;
      const bool sooner = try_edit(i, [middle](Line& one) {
        one.time.from = middle;
        one.time.to = middle;
      });
      if (sooner) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
  }

  void drop_headers() {
    for (std::size_t i = file_.head.size(); i-- > 0;) {
      const auto& what = (*file_.head[i].as<Header>()).what;
      // Without its %for a trace would be for nodes that state something else.
      if (std::holds_alternative<trace::VersionHeader>(what) ||
          std::holds_alternative<trace::ProfileHeader>(what) ||
          std::holds_alternative<trace::ForHeader>(what)) {
        continue;
      }
      trace::File candidate = file_;
      candidate.head.erase(candidate.head.begin() + static_cast<std::ptrdiff_t>(i));
      try_it(std::move(candidate));
    }
  }

  trace::File file_;
  const StillShows& still_shows_;
  std::size_t tried_ = 0;
};

// Returns whether the target died, hung or wrote nonsense, or did not even start again.
bool died(const CaseResult& result) {
  return std::ranges::any_of(result.failures, [](const auto& failure) { return failure.crash; });
}
bool played(const CaseResult& result) {
  return result.verdict < CaseVerdict::kError || died(result);
}
bool broke(const CaseResult& result) {
  return result.verdict == CaseVerdict::kFail || died(result);
}
bool kept(const CaseResult& result) {
  return result.verdict == CaseVerdict::kPass || result.verdict == CaseVerdict::kWeak;
}

// How a case ended: a smaller trace that tells two apart has to end so, too.
struct Ending {
  bool kept = false;
  std::vector<std::string> rules_of_death = {};
  explicit Ending(const CaseResult& result) : kept(shrink::kept(result)) {
    for (const runner::Failure& failure : result.failures) {
      if (failure.crash) rules_of_death = failure.requirements;
    }
  }
  friend bool operator==(const Ending&, const Ending&) = default;
};

struct Candidate {
  const trace::File* file;
  const trace::Case* one;
  std::size_t lines;
  Ending of_a;
  Ending of_b;
};

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

Shrunk shrink(const trace::File& file, const trace::Case& one, const StillShows& still_shows) {
  Shrunk out;
  Shrinker shrinker(alone(file, one), still_shows);
  if (shrinker.shows(shrinker.file())) {
    out.lines_before = shrinker.size();
    shrinker.run();
  }
  out.file = shrinker.file();
  out.lines = shrinker.size();
  out.tried = shrinker.tried();
  return out;
}

trace::File only(const trace::File& file, const trace::Case& one) {
  trace::File out{.head = file.head};
  out.cases.push_back(one);
  return out;
}

CaseResult play(const trace::File& file, const Player& player) {
  trace::File asked = file;
  if (!player.profile.empty()) {
    trace::set_header(asked, asked.cases.at(0), trace::ProfileHeader{player.profile});
  }
  CaseResult result{.reason = trace::state(asked, asked.cases.at(0), player.stated).text};
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
  if (!played(a) || !played(b)) return false;
  return died(a) != died(b) || (broke(a) && kept(b)) || (kept(a) && broke(b));
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
      if (!played(of_a) || !played(of_b)) {
        ++search.skipped;
        continue;
      }
      if (died(of_a) && died(of_b)) {
        search.both_died.push_back(one.name);
        continue;
      }
      ++search.compared;
      if (!differ(of_a, of_b)) continue;
      search.different.push_back(one.name);
      candidates.push_back({file, &one, one.lines().size(), Ending(of_a), Ending(of_b)});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& x, const Candidate& y) { return x.lines < y.lines; });
  if (candidates.size() > shrunk_max) {
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(shrunk_max),
                     candidates.end());
  }
  for (const Candidate& candidate : candidates) {
    const StillShows shows = [&](const trace::File& file) {
      const CaseResult of_a = play(file, a);
      const CaseResult of_b = play(file, b);
      return differ(of_a, of_b) && Ending(of_a) == candidate.of_a && Ending(of_b) == candidate.of_b;
    };
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
