#include "conformance/explore/liveness.h"

#include <algorithm>
#include <deque>
#include <functional>
#include <limits>
#include <set>
#include <unordered_map>
#include <vector>

#include "conformance/explore/sites.h"
#include "conformance/explore/visited.h"

namespace rubric::explore {
namespace {

using Vertex = std::uint32_t;
constexpr Vertex kNoVertex = std::numeric_limits<Vertex>::max();
constexpr std::size_t kVerticesMax = 5'000'000;  // About a gigabyte.

/// What fairness is asked of: an event of a node, the hearing of a copy by a node, or its end.
using Claim = std::uint64_t;
constexpr Claim kHearing = Claim{1} << 63;
constexpr Claim kEnding = Claim{1} << 62;

Claim hearing(Copy copy, std::size_t node) { return kHearing | Claim{copy.bits} << 8 | node; }
Claim own_event(std::size_t node, std::uint32_t what) { return Claim{what} << 8 | node; }

// Returns what a step claims. How a transmission ends is one event.
std::vector<Claim> claims_of(const Move& move) {
  std::vector<Claim> out;
  const auto own = [](std::uint32_t what) {
    return what == event::kJoinTimer || (what >= event::kDoneAcked && what < event::kReboot) ||
           (what >= event::kAckTimer && what < event::kSend);
  };
  if (move.kind == Move::Kind::kStep && own(move.what)) {
    const bool done = move.what == event::kDoneUnacked;
    out.push_back(own_event(move.node, done ? event::kDoneAcked : move.what));
  }
  if (move.kind == Move::Kind::kLose) out.push_back(kEnding | move.copy.bits);
  if (move.kind != Move::Kind::kDeliver) return out;
  if (!move.stays) out.push_back(kEnding | move.copy.bits);
  for (std::size_t i = 0; i < kNodesMax; ++i) {
    if ((move.hearers >> i & 1) != 0) out.push_back(hearing(move.copy, i));
  }
  if (move.confirmed) out.push_back(own_event(move.copy.sender(), event::kDoneAcked));
  return out;
}

/// Strongly connected parts of a graph, each a list of its vertices; those without a step are left
/// out. `next(v, i)` returns the i-th vertex that a step leads to from v, kNoVertex after the last.
class Parts {
 public:
  using Next = std::function<Vertex(Vertex, std::size_t)>;
  Parts(const std::vector<Vertex>& vertices, Next next) : next_(std::move(next)) {
    for (const Vertex v : vertices) of_[v];
    for (const Vertex v : vertices) {
      if (of_[v].number == 0) visit(v);
    }
  }
  std::vector<std::vector<Vertex>> found;

 private:
  struct Mark {
    std::uint32_t number = 0;  ///< Order of visits; 0: none yet.
    std::uint32_t low = 0;
    bool on_stack = false;
    bool loops = false;  ///< A step leads back to itself.
  };
  struct Frame {
    Vertex vertex;
    std::size_t next = 0;
  };

  // Tarjan's algorithm, with a stack of its own.
  void visit(Vertex root) {
    std::vector<Frame> frames;
    enter(root, frames);
    while (!frames.empty()) {
      Frame& frame = frames.back();
      const Vertex v = frame.vertex;
      const Vertex to = next_(v, frame.next++);
      if (to == kNoVertex) {
        frames.pop_back();
        leave(v);
        if (!frames.empty()) lower(frames.back().vertex, of_[v].low);
        continue;
      }
      const auto known = of_.find(to);
      if (known == of_.end()) continue;  // Not of this graph.
      if (to == v) known->second.loops = true;
      if (known->second.number == 0) {
        enter(to, frames);
      } else if (known->second.on_stack) {
        lower(v, known->second.number);
      }
    }
  }
  void enter(Vertex v, std::vector<Frame>& frames) {
    Mark& mark = of_[v];
    mark.number = mark.low = ++count_;
    mark.on_stack = true;
    stack_.push_back(v);
    frames.push_back({v});
  }
  void lower(Vertex v, std::uint32_t low) { of_[v].low = std::min(of_[v].low, low); }
  void leave(Vertex v) {
    if (of_[v].low != of_[v].number) return;
    std::vector<Vertex> part;
    do {
      part.push_back(stack_.back());
      stack_.pop_back();
      of_[part.back()].on_stack = false;
    } while (part.back() != v);
    if (part.size() > 1 || of_[v].loops) found.push_back(std::move(part));
  }

  Next next_;
  std::unordered_map<Vertex, Mark> of_;
  std::vector<Vertex> stack_;
  std::uint32_t count_ = 0;
};

/// A step inside a part.
struct Inside {
  Vertex to;
  std::size_t way;  ///< Index among all successors.
  std::vector<Claim> claims;
};

/// A strongly connected part with all that fairness asks about.
struct Part {
  std::unordered_map<Vertex, std::vector<Inside>> steps;
  std::unordered_map<Vertex, std::set<Claim>> has;  ///< Claims of any step from a state.
  std::set<Claim> taken;                            ///< Claims of steps inside.
};

class LoopSearch {
 public:
  explicit LoopSearch(Nodes& nodes)
      : nodes_(nodes), network_(nodes), sites_(nodes), packer_(nodes, sites_, network_) {}

  Liveness run() {
    Liveness out;
    out.limit = build();
    out.states = states_.size();
    if (*out.limit != '\0') return out;
    std::vector<Vertex> waiting;
    for (Vertex v = 0; v < states_.size(); ++v) {
      if (states_[v].waits != 0) waiting.push_back(v);
    }
    const Parts parts(waiting, [this](Vertex v, std::size_t i) {
      const std::size_t at = states_[v].first_step + i;
      return at < states_[v].first_step + states_[v].steps ? steps_[at] : kNoVertex;
    });
    out.parts = parts.found.size();
    for (const std::vector<Vertex>& part : parts.found) {
      if (const auto fair = fair_part(part)) {
        // The one that is reached first is the lasso's shortest beginning.
        out.violation = lasso(*fair);
        return out;
      }
    }
    return out;
  }

 private:
  struct State {
    Packed packed;
    Vertex parent = kNoVertex;
    std::uint16_t way = 0;
    std::uint16_t steps = 0;  ///< To others in which something waits.
    std::size_t first_step = 0;
    Mask waits = 0;  ///< Properties that promise an end here.
  };

  Mask waits(const World& world) const {
    const Options& options = nodes_.options();
    Mask out = 0;
    for (std::size_t i = 0; i < nodes_.count(); ++i) {
      const NodeFacts& f = nodes_.facts(world.node[i]);
      if (f.open) out |= bit(Property::kOneTerminal);
      const bool times_out = options.profile.ack_timeout_ticks != 0;
      if (f.open_sends && times_out) out |= bit(Property::kReliableEnds);
    }
    return out & options.properties;
  }

  Vertex visit(const World& world, Vertex parent, std::size_t way) {
    const Packed packed = packer_.pack(world);
    const auto [at, is_new] =
        index_.emplace(packer_.key(packed).bits, static_cast<Vertex>(states_.size()));
    if (is_new) {
      states_.push_back({packed, parent, static_cast<std::uint16_t>(way), 0, 0, waits(world)});
    }
    return at->second;
  }

  // Visits every state. Returns why not, or "".
  const char* build() {
    const Options& options = nodes_.options();
    World world;
    visit(network_.initial(), kNoVertex, 0);
    for (Vertex v = 0; v < states_.size(); ++v) {
      if (v % 4096 == 0) {
        const std::uint64_t most = options.memory_max_bytes;
        if (most != 0 && 2 * process_bytes() > most) return "more memory than --memory allows";
      }
      if (options.states_max != 0 && states_.size() > options.states_max) {
        return "as many states as --max-states allows";
      }
      if (states_.size() > kVerticesMax) return "more than 5 million states for --liveness";
      packer_.unpack(states_[v].packed, world);
      network_.successors(world, ways_on_);
      states_[v].first_step = steps_.size();
      for (std::size_t i = 0; i < ways_on_.size(); ++i) {
        const Vertex to = visit(ways_on_[i].world, v, i);
        if (states_[v].waits == 0 || states_[to].waits == 0) continue;
        steps_.push_back(to);
        ++states_[v].steps;
      }
      if (network_.overflowed()) return "more frames in flight than there is room for";
      if (nodes_.full() || sites_.full()) {
        return "more node states or frames than there are numbers for";
      }
    }
    return "";
  }

  Part look_at(const std::vector<Vertex>& vertices) {
    Part part;
    World world;
    for (const Vertex v : vertices) part.steps[v];
    for (const Vertex v : vertices) {
      packer_.unpack(states_[v].packed, world);
      network_.successors(world, ways_on_);
      for (std::size_t i = 0; i < ways_on_.size(); ++i) {
        std::vector<Claim> claims = claims_of(ways_on_[i].move);
        part.has[v].insert(claims.begin(), claims.end());
        const Vertex to = index_.at(packer_.key(packer_.pack(ways_on_[i].world)).bits);
        if (!part.steps.contains(to)) continue;
        part.taken.insert(claims.begin(), claims.end());
        part.steps[v].push_back({to, i, std::move(claims)});
      }
    }
    return part;
  }

  // Returns the part, or one inside it, in which a fair run can stay.
  std::optional<Part> fair_part(const std::vector<Vertex>& vertices) {
    Part part = look_at(vertices);
    std::unordered_map<Claim, std::size_t> count;
    for (const auto& [v, claims] : part.has) {
      for (const Claim claim : claims) ++count[claim];
    }
    std::vector<Vertex> rest;
    for (const auto& [claim, states] : count) {
      const bool event_waits = (claim & kHearing) == 0 && states == vertices.size();
      if (event_waits && !part.taken.contains(claim)) return std::nullopt;
    }
    for (const Vertex v : vertices) {
      const std::set<Claim>& claims = part.has[v];
      const bool fair = std::all_of(claims.begin(), claims.end(), [&](Claim claim) {
        return (claim & kHearing) == 0 || part.taken.contains(claim);
      });
      if (fair) rest.push_back(v);
    }
    if (rest.size() == vertices.size()) return part;
    const Parts smaller(rest, [&](Vertex v, std::size_t i) {
      const std::vector<Inside>& steps = part.steps.at(v);
      return i < steps.size() ? steps[i].to : kNoVertex;
    });
    for (const std::vector<Vertex>& one : smaller.found) {
      if (auto fair = fair_part(one)) return fair;
    }
    return std::nullopt;
  }

  // Goes on from `at` by a shortest way to a step that `wanted` accepts, and takes it.
  static void extend(const Part& part, Vertex& at, std::vector<std::pair<Vertex, Inside>>& loop,
                     const std::function<bool(const Inside&)>& wanted) {
    struct Came {
      Vertex from;
      const Inside* by;
    };
    std::unordered_map<Vertex, Came> came{{at, {kNoVertex, nullptr}}};
    std::deque<Vertex> waiting{at};
    for (; !waiting.empty(); waiting.pop_front()) {
      const Vertex v = waiting.front();
      for (const Inside& step : part.steps.at(v)) {
        if (!wanted(step)) {
          if (came.emplace(step.to, Came{v, &step}).second) waiting.push_back(step.to);
          continue;
        }
        std::vector<std::pair<Vertex, Inside>> way{{v, step}};
        for (Vertex back = v; came.at(back).by != nullptr; back = came.at(back).from) {
          way.emplace_back(came.at(back).from, *came.at(back).by);
        }
        loop.insert(loop.end(), way.rbegin(), way.rend());
        at = step.to;
        return;
      }
    }
  }

  static bool takes(const Inside& step, Claim claim) {
    return std::find(step.claims.begin(), step.claims.end(), claim) != step.claims.end();
  }

  // Returns whether a loop is fair to a claim: takes it, or, of an event, is once without it.
  static bool is_fair(const Part& part, const std::vector<std::pair<Vertex, Inside>>& loop,
                      Claim claim) {
    return std::any_of(loop.begin(), loop.end(), [&](const auto& step) {
      const bool lacks = (claim & kHearing) == 0 && !part.has.at(step.first).contains(claim);
      return lacks || takes(step.second, claim);
    });
  }

  Path lasso(const Part& part) {
    Vertex first = kNoVertex;
    std::set<Claim> all;
    for (const auto& [v, claims] : part.has) {
      first = std::min(first, v);  // The nearest.
      all.insert(claims.begin(), claims.end());
    }
    std::vector<std::pair<Vertex, Inside>> loop;
    Vertex at = first;
    for (const Claim claim : all) {
      if (is_fair(part, loop, claim)) continue;
      const bool taken = part.taken.contains(claim);
      extend(part, at, loop, [&](const Inside& step) {
        return taken ? takes(step, claim) : !part.has.at(step.to).contains(claim);
      });
    }
    if (loop.empty() || at != first) {
      extend(part, at, loop, [&](const Inside& step) { return step.to == first; });
    }
    return path_of(first, loop);
  }

  Path path_of(Vertex first, const std::vector<std::pair<Vertex, Inside>>& loop) {
    Path path{.violated = states_[first].waits};
    World world;
    const auto take = [&](Vertex from, std::size_t way) {
      packer_.unpack(states_[from].packed, world);
      network_.successors(world, ways_on_);
      path.moves.push_back(ways_on_[way].move);
    };
    std::vector<Vertex> stem;
    for (Vertex v = first; states_[v].parent != kNoVertex; v = states_[v].parent) stem.push_back(v);
    for (auto v = stem.rbegin(); v != stem.rend(); ++v) take(states_[*v].parent, states_[*v].way);
    path.loop = path.moves.size();
    for (const auto& [from, step] : loop) take(from, step.way);
    return path;
  }

  Nodes& nodes_;
  Network network_;
  Sites sites_;
  Packer packer_;
  Successors ways_on_;
  std::vector<State> states_;
  std::unordered_map<std::uint64_t, Vertex> index_;
  std::vector<Vertex> steps_;
};

}  // namespace

Liveness look_for_loops(Nodes& nodes) { return LoopSearch(nodes).run(); }

}  // namespace rubric::explore
