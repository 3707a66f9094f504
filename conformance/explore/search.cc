#include "conformance/explore/search.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <thread>
#include <utility>
#include <vector>

#include "conformance/explore/frontier.h"
#include "conformance/explore/independence.h"
#include "conformance/explore/liveness.h"
#include "conformance/explore/network.h"
#include "conformance/explore/sites.h"
#include "conformance/explore/visited.h"

namespace rubric::explore {
namespace {

// Returns what a vector's next growth needs beside what it has; 0 while that is far.
template <class T>
std::size_t growth_bytes(const std::vector<T>& growing) {
  return growing.size() > growing.capacity() / 4 * 3 ? 2 * growing.capacity() * sizeof(T) : 0;
}

using Clock = std::chrono::steady_clock;

constexpr const char* kNoMemory = "more memory than the system has";
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
  Worker(Nodes& nodes, Sites& sites, Visited& visited, bool by_mote, std::uint8_t number)
      : network(nodes),
        packer(nodes, sites, network),
        nodes_(nodes),
        orbit_(sites.symmetry.group().size()),
        visited_(visited),
        by_mote_(by_mote),
        number_(number) {}

  void start(const World& world) {
    const Packed packed = packer.pack(world);
    visited_.insert(packer.key(packed).bits);
    visited_.add_to_size(1);
    represented = 1;  // All motes are alike, and all sinks.
    add(packed, {});
  }

  /// Takes chunks until none is left.
  void work(const std::vector<Chunk>& chunks, std::atomic<std::size_t>& taken) {
    for (std::size_t i = taken++; i < chunks.size(); i = taken++) expand(chunks[i]);
  }

  /// Leaves, where the motes' steps are independent, those of one mote (independence.h).
  void reduce(const World& world, Successors& ways_on) const {
    if (by_mote_) keep_one_mote(nodes_, world, ways_on);
  }

  Network network;
  Packer packer;
  Frontier next;
  std::vector<PathLink> links;  ///< For every state that this thread found, in order.
  std::vector<Find> violations;
  std::vector<Find> weaknesses;
  std::uint64_t transitions = 0;
  std::uint64_t represented = 0;  ///< States of the orbits of those that it found.
  std::uint64_t hashed = 0;       ///< Of the found ones, those that are known by a hash.
  std::size_t inserted = 0;
  bool ended = false;  ///< It saw a state without a way on.
  Mask goals = 0;

 private:
  struct Pending {
    struct Key {
      Packed packed;
      StateKey key;
      std::size_t same = 1;  ///< Permutations that leave it as it is.
    };
    PathLink self;
    Successors ways_on;
    std::vector<Key> keys;
  };

  void expand(const Chunk& chunk) {
    const std::uint8_t* bytes = chunk.bytes;
    std::uint32_t index = chunk.first_index;
    for (std::size_t left = chunk.states; left != 0;) {
      const std::size_t group = std::min(left, kLookahead);
      for (std::size_t i = 0; i < group; ++i) {
        bytes += Frontier::read(bytes, nodes_.count(), packed_);
        look(pending_[i], {index++, chunk.thread, 0});
      }
      for (std::size_t i = 0; i < group; ++i) take(pending_[i]);
      left -= group;
    }
  }

  // Computes the successors, and prefetches their places in the visited set.
  void look(Pending& pending, PathLink self) {
    pending.self = self;
    packer.unpack(packed_, world_);
    network.successors(world_, pending.ways_on);
    judge(pending);
    reduce(world_, pending.ways_on);
    pending.keys.clear();
    for (const Successor& s : pending.ways_on) {
      Packed packed = packer.pack(s.world, &world_, packed_);
      const std::size_t same = packer.sort(packed);
      pending.keys.push_back({packed, packer.key(packed), same});
      visited_.prefetch(pending.keys.back().key.bits);
    }
  }

  void judge(const Pending& pending) {
    ended |= pending.ways_on.size() == 0;
    const std::uint64_t weak = network.known_weak();
    Mask violated = network.violated(world_, pending.ways_on);
    if (orbit_ > 1 && network.rests(world_, pending.ways_on)) violated |= judge_orbit();
    if (violated != 0) violations.push_back({pending.self, violated});
    if (network.known_weak() != weak && weaknesses.empty()) weaknesses.push_back({pending.self, 0});
    goals |= network.goals(world_);
  }

  // What happens when faults stop depends on the order of motes and sinks.
  Mask judge_orbit() {
    Mask violated = 0;
    std::vector<Packed> seen{packed_};
    World other;
    for (std::size_t g = 1; g < orbit_; ++g) {
      const Packed packed = packer.exchanged(packed_, g);
      if (std::find(seen.begin(), seen.end(), packed) != seen.end()) continue;
      seen.push_back(packed);
      packer.unpack(packed, other);
      violated |= network.broken_by_healing(other);
    }
    return violated;
  }

  void take(const Pending& pending) {
    transitions += pending.ways_on.size();
    for (std::size_t i = 0; i < pending.ways_on.size(); ++i) {
      const Successor& s = pending.ways_on[i];
      const auto& [packed, key, same] = pending.keys[i];
      goals |= s.goals;
      const bool is_new = visited_.insert(key.bits);
      if (!is_new && s.violated == 0) continue;
      const PathLink link{pending.self.index, pending.self.thread, static_cast<std::uint16_t>(i)};
      if (is_new) {
        ++inserted;
        represented += orbit_ / same;
        hashed += key.exact ? 0 : 1;
        add(packed, link);
      }
      // A step that breaks something counts even where it leads to a known state.
      if (s.violated != 0) step_violations.push_back({link, s.violated});
    }
  }

  void add(const Packed& packed, PathLink link) {
    next.add(packed, nodes_.count(), static_cast<std::uint32_t>(links.size()), number_);
    links.push_back(link);
  }

  Nodes& nodes_;
  std::size_t orbit_;
  Visited& visited_;
  bool by_mote_;
  std::uint8_t number_;
  Packed packed_;
  World world_;
  std::array<Pending, kLookahead> pending_;

 public:
  std::vector<Find> step_violations;  ///< Links are the steps that break something.
};

class Search {
 public:
  Search(Nodes& nodes, const std::function<void(const Progress&)>& report)
      : nodes_(nodes), report_(report), start_(Clock::now()), sites_(nodes) {
    by_mote_ = motes_are_independent(nodes.options());
    for (unsigned i = 0; i < nodes.options().threads; ++i) {
      workers_.push_back(std::make_unique<Worker>(nodes, sites_, visited_, by_mote_,
                                                  static_cast<std::uint8_t>(i)));
    }
  }

  Result run() {
    try {
      workers_[0]->start(workers_[0]->network.initial());
      while (level()) ++depth_;
    } catch (const std::bad_alloc&) {
      limit_ = kNoMemory;
    }
    if (!found_violation()) check_reductions();
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
      if (!find_room(chunks, first)) return false;
      const std::size_t count = batch_size(chunks, first);
      batch({chunks.begin() + static_cast<std::ptrdiff_t>(first),
             chunks.begin() + static_cast<std::ptrdiff_t>(first + count)});
      first += count;
      if (!may_go_on()) return false;
    }
    return !found_violation();
  }

  // Makes room for the successors of a batch. Returns false if --memory does not allow it.
  bool find_room(const std::vector<Chunk>& chunks, std::size_t first) {
    std::size_t wanted = 0;
    for (std::size_t i = first; i < chunks.size() && wanted < kBatchMin; ++i) {
      wanted += chunks[i].states;
    }
    wanted = wanted * kWaysOnMax / 8;
    std::size_t more = visited_.room() < wanted ? 2 * visited_.memory_bytes() : 0;
    for (const auto& worker : workers_) {
      more += growth_bytes(worker->links) + growth_bytes(worker->next.bytes());
    }
    const std::uint64_t most = nodes_.options().memory_max_bytes;
    if (most != 0 && process_bytes() + more > most) {
      limit_ = "more memory than --memory allows";
      return false;
    }
    if (visited_.room() < wanted) visited_.reserve(wanted);
    return true;
  }

  // Returns how many chunks surely find room for their successors.
  std::size_t batch_size(const std::vector<Chunk>& chunks, std::size_t first) const {
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
      others.emplace_back([&, i] { work(i, chunks, taken); });
    }
    work(0, chunks, taken);
    for (std::thread& other : others) other.join();
    for (auto& worker : workers_) visited_.add_to_size(std::exchange(worker->inserted, 0));
    for (const Chunk& chunk : chunks) waiting_ -= chunk.states;
    if (report_) report_(progress());
  }

  void work(std::size_t worker, const std::vector<Chunk>& chunks, std::atomic<std::size_t>& taken) {
    try {
      workers_[worker]->work(chunks, taken);
    } catch (const std::bad_alloc&) {
      out_of_memory_ = true;
    }
  }

  bool may_go_on() {
    if (out_of_memory_) limit_ = kNoMemory;
    const std::uint64_t most = nodes_.options().states_max;
    if (most != 0 && visited_.size() >= most) limit_ = "as many states as --max-states allows";
    if (nodes_.full() || sites_.full())
      limit_ = "more node states or frames than there are numbers for";
    for (const auto& worker : workers_) {
      if (worker->network.overflowed()) limit_ = "more frames in flight than there is room for";
      if (worker->links.size() > std::numeric_limits<std::uint32_t>::max() / 2) {
        limit_ = "more states than there are numbers for";
      }
    }
    return *limit_ == '\0';
  }

  // Checks what the reductions rest on. A violation does not need it: it is a path of the machine
  // itself.
  void check_reductions() {
    bool alike = false;
    try {
      alike = sites_.symmetry.holds();
    } catch (const std::bad_alloc&) {
      limit_ = kNoMemory;
    }
    if (!alike) depth_ = 0;  // Then nothing was proved.
    if (!alike && limit_ != kNoMemory)
      limit_ = "motes or sinks that are not treated alike; give --no-symmetry";
    const bool ended = std::any_of(workers_.begin(), workers_.end(),
                                   [](const auto& worker) { return worker->ended; });
    if (by_mote_ && !ended && *limit_ == '\0')
      limit_ = "motes whose steps never end; give --no-partial-order";
  }

  bool found_violation() const {
    return std::any_of(workers_.begin(), workers_.end(), [](const auto& worker) {
      return !worker->violations.empty() || !worker->step_violations.empty();
    });
  }

  Progress progress() const {
    Progress p{.states = visited_.size()};
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
    // Of each state of the search the path has one of its orbit: the way on that leads to the orbit
    // of the next.
    Path path{.violated = violated};
    Worker& worker = *workers_[0];
    World world = worker.network.initial();
    Packed kept = worker.packer.pack(world);
    World kept_world;
    Successors ways_on;
    for (auto way = ways.rbegin(); way != ways.rend(); ++way) {
      worker.packer.unpack(kept, kept_world);
      worker.network.successors(kept_world, ways_on);
      worker.reduce(kept_world, ways_on);
      const Successor step = ways_on[*way];
      kept = worker.packer.pack(step.world);
      worker.packer.sort(kept);
      worker.network.successors(world, ways_on);
      const auto like = std::find_if(ways_on.begin(), ways_on.end(), [&](const Successor& s) {
        Packed packed = worker.packer.pack(s.world);
        worker.packer.sort(packed);
        return packed == kept && s.violated == step.violated;
      });
      if (like == ways_on.end()) break;  // Not if the symmetry holds.
      path.moves.push_back(like->move);
      world = like->world;
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
    Result result{.progress = progress(), .violation = shortest_violation()};
    result.limit = result.violation && limit_ != kNoMemory ? "" : limit_;
    result.complete = !result.violation && *limit_ == '\0';
    double hashed = 0;
    for (const auto& worker : workers_) {
      result.goals |= worker->goals;
      result.known_weak_states += worker->network.known_weak();
      result.represented_states += worker->represented;
      hashed += static_cast<double>(worker->hashed);
    }
    for (const auto& worker : workers_) {
      if (worker->weaknesses.empty() || result.known_weakness) continue;
      const Find& f = worker->weaknesses.front();
      result.known_weakness = path_to(workers_[f.link.thread]->links[f.link.index], 0);
    }
    const Mask either = bit(Goal::kJoinedFirst) | bit(Goal::kJoinedSecond);
    const bool sinks_alike = nodes_.options().symmetry && nodes_.options().sinks > 1;
    if (sinks_alike && (result.goals & either) != 0) result.goals |= either;
    result.by_mote = by_mote_;
    result.omission_probability =
        hashed * static_cast<double>(visited_.size()) / 18446744073709551616.0;
    result.step_acted = nodes_.step_acted();
    result.node_states = nodes_.states();
    result.frames = nodes_.frames();
    std::size_t links = 0;
    for (const auto& worker : workers_) links += worker->links.capacity() * sizeof(PathLink);
    result.memory_bytes =
        visited_.memory_bytes() + links + nodes_.memory_bytes() + sites_.memory_bytes();
    result.memory_per_state_bytes =
        (visited_.memory_bytes() + links) / std::max<std::size_t>(visited_.size(), 1);
    return result;
  }

  Nodes& nodes_;
  const std::function<void(const Progress&)>& report_;
  Clock::time_point start_;
  Sites sites_;
  bool by_mote_ = false;  ///< The motes' steps are independent, and taken mote by mote.
  Visited visited_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::uint32_t depth_ = 0;
  std::uint64_t waiting_ = 0;
  const char* limit_ = "";
  std::atomic<bool> out_of_memory_ = false;
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
  Result result = Search(nodes, report).run();
  if (!nodes.options().liveness || !result.complete) return result;
  Liveness liveness = look_for_loops(nodes);
  result.liveness_states = liveness.states;
  result.liveness_parts = liveness.parts;
  result.violation = std::move(liveness.violation);
  result.limit = liveness.limit;
  result.complete = !result.violation && *liveness.limit == '\0';
  return result;
}

}  // namespace rubric::explore
