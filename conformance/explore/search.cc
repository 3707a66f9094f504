#include "conformance/explore/search.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <new>
#include <thread>
#include <utility>
#include <vector>

#include "conformance/explore/network.h"

namespace rubric::explore {
namespace {

// States that wait to be expanded, packed one after the other.

/// The state, and the index among its successors, from which a state was reached first.
struct PathLink {
  static constexpr std::uint16_t kStart = 0xFFFF;
  std::uint32_t index = 0;  ///< Index among the states of its thread.
  std::uint16_t thread = 0;
  std::uint16_t way = kStart;
};

/// Neighbouring states of one thread.
struct Chunk {
  const std::uint8_t* bytes = nullptr;
  std::size_t states = 0;
  std::uint32_t first_index = 0;
  std::uint8_t thread = 0;
};

class Frontier {
 public:
  void add(const Network& network, const World& world, std::uint32_t index, std::uint8_t thread) {
    if (states_ % kChunkStates == 0) marks_.push_back({bytes_.size(), index, thread});
    ++states_;
    std::array<std::uint8_t, kPackedMax> packed;
    const std::size_t size = network.pack(world, packed.data());
    bytes_.insert(bytes_.end(), packed.data(), packed.data() + size);
  }
  std::size_t states() const { return states_; }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  /// Appends its chunks, which stay valid while it is neither moved nor added to.
  void chunks(std::vector<Chunk>& out) const {
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      const bool last = i + 1 == marks_.size();
      const std::size_t states = last ? states_ - i * kChunkStates : kChunkStates;
      out.push_back(
          {bytes_.data() + marks_[i].offset_bytes, states, marks_[i].index, marks_[i].thread});
    }
  }

 private:
  static constexpr std::size_t kChunkStates = 512;
  static constexpr std::size_t kPackedMax = 3 * kNodesMax + 2 + 3 * World::kCopiesMax;
  struct Mark {
    std::size_t offset_bytes;
    std::uint32_t index;
    std::uint8_t thread;
  };
  std::vector<std::uint8_t> bytes_;
  std::vector<Mark> marks_;
  std::size_t states_ = 0;
};

// The set of visited states, as fingerprints of 64 bits: eight bytes a place.

/// Open addressing; several threads insert at once without locks. It grows between batches, not
/// during one.
class Visited {
 public:
  Visited() { allocate(std::size_t{1} << 18); }

  /// Makes room for so many more. No thread may insert meanwhile.
  void reserve(std::size_t more);
  /// Returns how many more fit without growing.
  std::size_t room() const;
  /// Prefetches the place of a fingerprint, for an insert soon.
  void prefetch(std::uint64_t fingerprint) const {
    __builtin_prefetch(&slots_[fingerprint & mask_], 1, 1);
  }
  /// Inserts `fingerprint`, which is not 0. Returns true if it is new.
  bool insert(std::uint64_t fingerprint) {
    for (std::size_t i = fingerprint & mask_;; i = (i + 1) & mask_) {
      std::uint64_t there = slots_[i].load(std::memory_order_relaxed);
      if (there == fingerprint) return false;
      if (there != 0) continue;
      if (slots_[i].compare_exchange_strong(there, fingerprint, std::memory_order_relaxed)) {
        return true;
      }
      if (there == fingerprint) return false;
    }
  }
  /// Counts inserted states after a batch, since counting each would cost more than inserting.
  void add_to_size(std::size_t inserted) { size_ += inserted; }
  std::size_t size() const { return size_; }
  std::size_t memory_bytes() const { return (mask_ + 1) * sizeof(std::uint64_t); }

 private:
  struct Release {
    std::size_t bytes;
    void operator()(std::atomic<std::uint64_t>* slots) const;
  };
  void allocate(std::size_t slots);

  std::unique_ptr<std::atomic<std::uint64_t>[], Release> slots_ {
    nullptr, Release { 0 }
  };
  std::size_t mask_ = 0;
  std::size_t size_ = 0;
};

constexpr std::size_t kFullPercent = 60;
constexpr const char* kNoMemory = "more memory than the system has";

void Visited::Release::operator()(std::atomic<std::uint64_t>* slots) const {
  if (slots != nullptr) munmap(slots, bytes);
}

// Allocates zeroed memory from the system, in large pages if there are any.
void Visited::allocate(std::size_t slots) {
  const std::size_t bytes = slots * sizeof(std::uint64_t);
  void* const memory =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  madvise(memory, bytes, MADV_HUGEPAGE);
  slots_ = {static_cast<std::atomic<std::uint64_t>*>(memory), Release{bytes}};
  mask_ = slots - 1;
}

std::size_t Visited::room() const {
  const std::size_t most = (mask_ + 1) / 100 * kFullPercent;
  return most > size_ ? most - size_ : 0;
}

void Visited::reserve(std::size_t more) {
  while (room() < more) {
    const auto old = std::move(slots_);
    const std::size_t old_slots = mask_ + 1;
    allocate(2 * old_slots);
    for (std::size_t i = 0; i < old_slots; ++i) {
      const std::uint64_t fingerprint = old[i].load(std::memory_order_relaxed);
      if (fingerprint != 0) insert(fingerprint);
    }
  }
}

// Returns the memory that the process has in use, 0 if the system does not say.
std::size_t process_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t size = 0;
  std::size_t resident = 0;
  if (!(statm >> size >> resident)) return 0;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

// Returns what a vector's next growth needs beside what it has; 0 while that is far.
template <class T>
std::size_t growth_bytes(const std::vector<T>& growing) {
  return growing.size() > growing.capacity() / 4 * 3 ? 2 * growing.capacity() * sizeof(T) : 0;
}

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
    try {
      workers_[0]->start(workers_[0]->network.initial());
      while (level()) ++depth_;
    } catch (const std::bad_alloc&) {
      limit_ = kNoMemory;
    }
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
  Search search(nodes, report);
  return search.run();
}

}  // namespace rubric::explore
