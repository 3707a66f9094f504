// The tuple space, in which PCs and robots meet. (paper: the PEIS tuplespace)
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rubric::space {

/// A tuple, or an event, which is one that does not stay.
struct Tuple {
  std::string key;              ///< Words with '/' between them, such as "11/motes/5/state".
  std::string data;             ///< A JSON object.
  std::string creator;          ///< Who wrote it; empty where a person wrote the data alone.
  std::int64_t written_ms = 0;  ///< Since 1970, by the creator's clock; 0: not said.
  bool stays = false;           ///< It was there before the subscription.
  std::string wrong = {};       ///< Why it makes no sense, so that it has no data; mostly empty.
};

/// Returns whether a key is one of a filter's: `+` stands for a word, a last `#` for all that
/// follow.
bool matches(std::string_view filter, std::string_view key);

/// A participant's view of the space. Used by one thread.
class Space {
 public:
  enum class Stay : std::uint8_t {
    kTuple,  ///< Later subscribers see it, too, until another takes its place.
    kEvent,  ///< Only those who have subscribed see it.
  };

  virtual ~Space() = default;
  /// Writes data under a key, by this participant and now. Returns when that was, in
  /// Tuple::written_ms, by which it knows its own tuple again.
  virtual std::int64_t put(const std::string& key, const std::string& data, Stay stay) = 0;
  /// Writes a payload as it is under a whole topic, for programs with conventions of their own. It
  /// stays. Does nothing where there are no such programs.
  virtual void announce(const std::string& topic, const std::string& payload) = 0;
  /// Takes a tuple away.
  virtual void remove(const std::string& key) = 0;
  /// From now on take() has what matches, and first the tuples that are there.
  virtual void subscribe(const std::string& filter) = 0;
  /// Returns what has come since, in the order in which each participant wrote it.
  virtual std::vector<Tuple> take() = 0;
};

}  // namespace rubric::space
