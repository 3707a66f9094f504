// Writes a valid frame from the tables, from the carrier's first field on, along a route.
#pragma once

#include "codec/generate/draft.h"
#include "codec/generate/random.h"
#include "codec/reflect/schema.h"
#include "codec/runtime/bytes.h"

namespace rubric::generate {

/// One attempt. Chance may lead to something impossible (a count that leaves no room, application
/// numbers that happen to name another message): then it fails, and the next one may not.
class FrameWriter {
 public:
  /// `max_bytes`: of the frame, in its framing.
  FrameWriter(const reflect::Route& route, bool radio, std::size_t max_bytes, Random& random);

  /// Writes the frame. Returns false if the attempt failed.
  bool write(const reflect::Type& carrier);

  Draft& draft() { return draft_; }

 private:
  using Field = reflect::Field;
  using Type = reflect::Type;

  /// The structure that a field is written into.
  struct Place {
    const Type& type;
    std::uint32_t scope;
    std::size_t base;
    std::size_t end;  ///< None of its bytes is after this.
    bool hard;
  };

  std::size_t size() const { return draft_.bytes.size(); }
  Bytes from(std::size_t base) const {
    return Bytes(draft_.bytes.data() + base, draft_.bytes.size() - base);
  }
  std::size_t left(const Place& place) const { return place.end - size(); }
  std::uint32_t add_part(PartKind kind, const Field& f, const Place& place);
  void close_part(std::uint32_t part);
  std::uint32_t measure_of(const reflect::Expr& expr, const Place& place) const;
  bool goes_on() const { return !reached_ && route_.offset >= size(); }

  bool structure(const Type& type, std::uint32_t parent, std::size_t room, bool hard);
  bool field(const Field& f, std::uint16_t index, const Place& place);
  bool number(const Field& f, const Place& place);
  bool forced(const Field& f, std::size_t at, std::int64_t& value);
  std::int64_t most_for(const Field& f, const Place& place) const;
  bool measures_room(const Field& f, const Place& place) const;
  void put(const Field& f, std::int64_t value);
  bool array(const Field& f, const Place& place);
  bool varying(const Field& f, const Place& place);
  bool opaque(const Field& f, const Place& place);
  void text(const Field& f, std::size_t bytes);
  bool nested(const Field& f, const Place& place);
  bool sized(const Field& f, const Type& type, std::uint32_t part, const Place& place);
  bool fixed(const Field& f, const Type& type, std::uint32_t part, const Place& place);
  bool takes_all(std::uint32_t first_part) const;
  void noise(std::size_t bytes);
  void stale(std::size_t room);
  bool is_interpreted(const Type& type, std::uint16_t index) const;
  bool interpreted(const Field& f, std::uint16_t index, const Place& place);
  bool inside(std::uint16_t index, const Place& place);
  bool stays_opaque(std::uint16_t index, std::size_t at, const Place& place) const;

  const reflect::Route& route_;
  std::size_t max_bytes_;
  Random& random_;
  Draft draft_;
  bool reached_ = false;
};

}  // namespace rubric::generate
