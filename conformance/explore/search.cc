#include "conformance/explore/search.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <memory>
#include <thread>
#include <utility>

#include "conformance/explore/frontier.h"
#include "conformance/explore/visited.h"

namespace rubric::explore {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLookahead = 16;    // States whose successors are looked up together.
constexpr std::size_t kWaysOnMax = 256;   // For one state; room is kept for so many.
constexpr std::size_t kBatchMin = 16384;  // States between two looks at the room.

/// A state that breaks something, or has a known weakness.
struct Find {
  PathLink link;
  Mask violated = 0;
};

/// A thread's share of the search.
class Worker {
 public:
  Worker(Nodes& nodes, Visited& visited, std::uint8_t number)
      : network(nodes), visited_(visited), number_(number) {}

  void start(const World& world) {
    visited_.insert(network.fingerprint(world));
    visited_.add_to_size(1);
    add(world, {});
  }

  /// Takes chunks until none is left.
  void work(const std::vector<Chunk>& chunks, std::atomic<std::size_t>& taken) {
    for (std::size_t i = taken++; i < chunks.size(); i = taken++) expand(chunks[i]);
  }

  Network network;
  Frontier next;
  std::vector<PathLink> links;  ///< For every state that this thread found, in order.
  std::vector<Find> violations;
  std::vector<Find> weaknesses;
  std::uint64_t transitions = 0;
  std::size_t inserted = 0;
  Mask goals = 0;

 private:
  struct Pending {
    PathLink self;
    Successors ways_on;
    std::vector<std::uint64_t> fingerprints;
  };

  void expand(const Chunk& chunk) {
    const std::uint8_t* bytes = chunk.bytes;
    std::uint32_t index = chunk.first_index;
    for (std::size_t left = chunk.states; left != 0;) {
      const std::size_t group = std::min(left, kLookahead);
      for (std::size_t i = 0; i < group; ++i) {
        bytes += network.unpack(bytes, world_);
        look(pending_[i], {index++, chunk.thread, 0});
      }
      for (std::size_t i = 0; i < group; ++i) take(pending_[i]);
      left -= group;
    }
  }

  // Computes the successors, and prefetches their places in the visited set.
  void look(Pending& pending, PathLink self) {
    pending.self = self;
    network.successors(world_, pending.ways_on);
    pending.fingerprints.clear();
    for (const Successor& s : pending.ways_on) {
      pending.fingerprints.push_back(network.fingerprint(s.world));
      visited_.prefetch(pending.fingerprints.back());
    }
    const std::uint64_t weak = network.known_weak();
    const Mask violated = network.violated(world_, pending.ways_on);
    if (violated != 0) violations.push_back({self, violated});
    if (network.known_weak() != weak && weaknesses.empty()) weaknesses.push_back({self, 0});
    goals |= network.goals(world_);
  }

  void take(const Pending& pending) {
    transitions += pending.ways_on.size();
    for (std::size_t i = 0; i < pending.ways_on.size(); ++i) {
      const Successor& s = pending.ways_on[i];
      goals |= s.goals;
      const bool is_new = visited_.insert(pending.fingerprints[i]);
      if (!is_new && s.violated == 0) continue;
      const PathLink link{pending.self.index, pending.self.thread, static_cast<std::uint16_t>(i)};
      if (is_new) {
        ++inserted;
        add(s.world, link);
      }
      // A step that breaks something counts even where it leads to a known state.
      if (s.violated != 0) step_violations.push_back({link, s.violated});
    }
  }

  void add(const World& world, PathLink link) {
    next.add(network, world, static_cast<std::uint32_t>(links.size()), number_);
    links.push_back(link);
  }

  Visited& visited_;
  std::uint8_t number_;
  World world_;
  std::array<Pending, kLookahead> pending_;

 public:
  std::vector<Find> step_violations;  ///< Links are the steps that break something.
};

class Search {
 public:
  Search(Nodes& nodes, const std::function<void(const Progress&)>& report)
      : nodes_(nodes), report_(report), start_(Clock::now()) {
    for (unsigned i = 0; i < nodes.options().threads; ++i) {
      workers_.push_back(std::make_unique<Worker>(nodes, visited_, static_cast<std::uint8_t>(i)));
    }
  }

  Result run() {
    workers_[0]->start(workers_[0]->network.initial());
    while (level()) ++depth_;
    return finish();
  }

 private:
  // Expands every state of one depth. Returns false if nothing is left, or the search has to stop.
  bool level() {
    std::vector<Frontier> frontiers;
    std::vector<Chunk> chunks;
    for (auto& worker : workers_) {
      frontiers.push_back(std::move(worker->next));
      worker->next = Frontier();
    }
    for (const Frontier& frontier : frontiers) frontier.chunks(chunks);
    if (chunks.empty()) return false;
    waiting_ = 0;
    for (const Chunk& chunk : chunks) waiting_ += chunk.states;
    for (std::size_t first = 0; first < chunks.size();) {
      const std::size_t count = batch_size(chunks, first);
      batch({chunks.begin() + static_cast<std::ptrdiff_t>(first),
             chunks.begin() + static_cast<std::ptrdiff_t>(first + count)});
      first += count;
      if (!may_go_on()) return false;
    }
    return !found_violation();
  }

  // Returns how many chunks surely find room for their successors.
  std::size_t batch_size(const std::vector<Chunk>& chunks, std::size_t first) {
    std::size_t wanted = 0;
    for (std::size_t i = first; i < chunks.size() && wanted < kBatchMin; ++i) {
      wanted += chunks[i].states;
    }
    if (visited_.room() < wanted * kWaysOnMax / 8) visited_.reserve(wanted * kWaysOnMax / 8);
    std::size_t states = 0;
    std::size_t count = 0;
    while (first + count < chunks.size() &&
           (count == 0 ||
            (states + chunks[first + count].states) * kWaysOnMax / 8 <= visited_.room())) {
      states += chunks[first + count++].states;
    }
    return count;
  }

  void batch(const std::vector<Chunk>& chunks) {
    std::atomic<std::size_t> taken = 0;
    std::vector<std::thread> others;
    for (std::size_t i = 1; i < workers_.size() && i < chunks.size(); ++i) {
      others.emplace_back([&, i] { workers_[i]->work(chunks, taken); });
    }
    workers_[0]->work(chunks, taken);
    for (std::thread& other : others) other.join();
    for (auto& worker : workers_) visited_.add_to_size(std::exchange(worker->inserted, 0));
    for (const Chunk& chunk : chunks) waiting_ -= chunk.states;
    if (report_) report_(progress());
  }

  bool may_go_on() {
    const std::uint64_t most = nodes_.options().states_max;
    if (most != 0 && visited_.size() >= most) limit_ = "as many states as --max-states allows";
    if (nodes_.full()) limit_ = "more node states or frames than there are numbers for";
    for (const auto& worker : workers_) {
      if (worker->network.overflowed()) limit_ = "more frames in flight than there is room for";
      if (worker->links.size() > std::numeric_limits<std::uint32_t>::max() / 2) {
        limit_ = "more states than there are numbers for";
      }
    }
    return *limit_ == '\0';
  }

  bool found_violation() const {
    return std::any_of(workers_.begin(), workers_.end(), [](const auto& worker) {
      return !worker->violations.empty() || !worker->step_violations.empty();
    });
  }

  Progress progress() const {
    Progress p;
    p.states = visited_.size();
    for (const auto& worker : workers_) p.transitions += worker->transitions;
    p.depth = depth_;
    for (const auto& worker : workers_) p.waiting += worker->next.states();
    p.waiting += waiting_;
    p.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    return p;
  }

  // Returns the moves that lead to a state: follows its links back, and walks them forward.
  Path path_to(PathLink last, Mask violated) {
    std::vector<std::uint16_t> ways;
    const bool at_start = last.way == PathLink::kStart;
    for (PathLink link = last; !at_start && link.way != PathLink::kStart;
         link = workers_[link.thread]->links[link.index]) {
      ways.push_back(link.way);
    }
    Path path;
    path.violated = violated;
    Network& network = workers_[0]->network;
    World world = network.initial();
    Successors ways_on;
    for (auto way = ways.rbegin(); way != ways.rend(); ++way) {
      network.successors(world, ways_on);
      path.moves.push_back(ways_on[*way].move);
      world = ways_on[*way].world;
    }
    return path;
  }

  // Returns the shortest violation. A step's violation is one move shorter than that of the state
  // that it leads to, but states of a level are checked when their steps are taken: those of states
  // come first.
  std::optional<Path> shortest_violation() {
    for (const bool of_states : {true, false}) {
      const Find* best = nullptr;
      for (const auto& worker : workers_) {
        for (const Find& f : of_states ? worker->violations : worker->step_violations) {
          if (best == nullptr || lowest(f.violated) < lowest(best->violated)) best = &f;
        }
      }
      if (best == nullptr) continue;
      const PathLink last =
          of_states ? workers_[best->link.thread]->links[best->link.index] : best->link;
      return path_to(last, best->violated);
    }
    return std::nullopt;
  }
  static Mask lowest(Mask mask) { return mask & (~mask + 1); }

  Result finish() {
    Result result;
    result.progress = progress();
    result.violation = shortest_violation();
    result.limit = result.violation ? "" : limit_;
    result.complete = !result.violation && *limit_ == '\0';
    for (const auto& worker : workers_) {
      result.goals |= worker->goals;
      result.known_weak_states += worker->network.known_weak();
    }
    for (const auto& worker : workers_) {
      if (worker->weaknesses.empty() || result.known_weakness) continue;
      const Find& f = worker->weaknesses.front();
      result.known_weakness = path_to(workers_[f.link.thread]->links[f.link.index], 0);
    }
    result.step_acted = nodes_.step_acted();
    result.node_states = nodes_.states();
    result.frames = nodes_.frames();
    std::size_t links = 0;
    for (const auto& worker : workers_) links += worker->links.capacity() * sizeof(PathLink);
    result.memory_bytes = visited_.memory_bytes() + links + nodes_.memory_bytes();
    result.memory_per_state_bytes =
        (visited_.memory_bytes() + links) / std::max<std::size_t>(visited_.size(), 1);
    return result;
  }

  Nodes& nodes_;
  const std::function<void(const Progress&)>& report_;
  Clock::time_point start_;
  Visited visited_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::uint32_t depth_ = 0;
  std::uint64_t waiting_ = 0;
  const char* limit_ = "";
};

}  // namespace

Mask expected_goals(const Options& o) {
  Mask goals = bit(Goal::kJoinedFirst) | bit(Goal::kListed);
  const bool expires = o.loss || !o.prompt;  // Else the answer is always there first.
  const auto add = [&](bool reachable, Goal goal) {
    if (reachable) goals |= bit(goal);
  };
  add(expires && o.profile.join_requests_max > 1, Goal::kRetried);
  add(o.sinks > 1, Goal::kJoinedSecond);
  add(o.sinks > 1, Goal::kSecondOffer);
  add(expires && o.profile.join_fail_signalled, Goal::kFailed);
  add(o.calls > 1, Goal::kJoinedAgain);
  add(o.calls > 1 && !o.prompt, Goal::kStaleReply);
  add((o.loss && o.profile.ack_join_max > 1) || o.dup, Goal::kRepeatedAck);
  add(o.motes > 1, Goal::kInterleaved);
  add(o.motes > 1, Goal::kSameIsland);
  add(o.motes > 1 && o.sinks > 1, Goal::kTwoIslands);
  add(o.loss, Goal::kOrphan);
  add(o.reboots > 0, Goal::kGhost);
  if (o.scope == Scope::kFull) {
    add(true, Goal::kDelivered);
    add(true, Goal::kAckedMessage);
    add(o.profile.ack_timeout_ticks != 0 && !o.prompt, Goal::kTimedOut);
    add(o.sinks > 1, Goal::kForeignIgnored);
  }
  return goals;
}

Result explore(Nodes& nodes, const std::function<void(const Progress&)>& report) {
  Search search(nodes, report);
  return search.run();
}

}  // namespace rubric::explore
