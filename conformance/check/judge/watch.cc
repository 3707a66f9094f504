#include "conformance/check/judge/watch.h"

#include <algorithm>
#include <utility>

#include "codec/reflect/requirements.h"

namespace rubric::check {
namespace {

// Returns the subject of a fact: "mote 2" of "mote 2: 35 frames on the air", whose numbers grow.
std::string subject(const std::string& fact) { return fact.substr(0, fact.find(':')); }

std::string name_of(ReqId id) {
  if (id == ReqId::kNone) return "something";
  return reflect::requirement(id).id;
}

// Returns whether an episode has grown over the finding, or begins earlier than it seemed.
bool counts(const Finding& episode, const Finding& finding) {
  return episode.requirement == finding.requirement && episode.node == finding.node &&
         episode.place.file == finding.place.file && episode.count > 1 &&
         episode.place.frame <= finding.place.frame && finding.place.frame <= episode.last.frame;
}

}  // namespace

void Watch::look(const Finding& finding, Known& known, std::int64_t now_us,
                 std::vector<Change>& out) {
  known.stands = true;
  if (!known.told && now_us - known.since_us >= settle_us_) {
    known.told = true;
    known.finding = finding;
    out.push_back({Change::What::kFound, finding, {}, {}});
  } else if (known.told && known.finding.severity != finding.severity) {
    out.push_back({Change::What::kChanged, finding, known.finding.severity, {}});
    known.finding = finding;
  }
}

std::vector<Change> Watch::update(const Report& report, std::int64_t now_us) {
  for (auto& [key, known] : known_) known.stands = false;
  std::vector<Change> found;
  for (const Finding& finding : report.findings) {
    Key key{finding.place.file, finding.place.frame,
            reflect::requirement_index(finding.requirement), finding.node, 0};
    auto at = known_.find(key);
    while (at != known_.end() && at->second.stands) {
      ++std::get<4>(key);
      at = known_.find(key);
    }
    if (at == known_.end()) {
      at = known_.emplace(std::move(key), Known{now_us, false, true, {}}).first;
    }
    look(finding, at->second, now_us, found);
  }
  std::vector<Change> out;
  for (auto at = known_.begin(); at != known_.end();) {
    Known& known = at->second;
    if (known.stands) {
      ++at;
      continue;
    }
    const auto& all = report.findings;
    const bool counted = std::any_of(
        all.begin(), all.end(), [&](const Finding& other) { return counts(other, known.finding); });
    if (known.told && !counted) {
      std::string why = reason(known.finding, report);
      out.push_back({Change::What::kWithdrawn, std::move(known.finding), {}, std::move(why)});
    }
    at = known_.erase(at);
  }
  facts_.clear();
  for (const std::string& fact : report.facts) facts_.insert(subject(fact));
  out.insert(out.end(), std::make_move_iterator(found.begin()),
             std::make_move_iterator(found.end()));
  return out;
}

std::string Watch::reason(const Finding& finding, const Report& report) const {
  for (const Finding& other : report.findings) {
    const bool same = finding.place.frame != 0 && other.place.file == finding.place.file &&
                      other.place.frame == finding.place.frame;
    if (!same) continue;
    std::string out = "the frame now shows " + name_of(other.requirement);
    if (!other.node.empty()) out += " of " + other.node;
    return out;
  }
  std::string known;
  for (const std::string& fact : report.facts) {
    if (facts_.contains(subject(fact))) continue;
    known += (known.empty() ? "" : "; ") + fact;
  }
  if (!known.empty()) return "what is known by now: " + known;
  return "frames that came later explain it";
}

}  // namespace rubric::check
