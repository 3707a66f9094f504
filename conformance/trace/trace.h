// The .rtr text trace as plain values: golden trace, log of a run, input of the offline checker,
// counterexample. Grammar and meaning: spec/trace/README.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "codec/runtime/rule.h"
#include "conformance/trace/parameters.h"

namespace rubric::trace {

/// The place of something in its file, counted from 1; zeros for what was built in code. It is no
/// part of the value: places always compare equal.
struct Place {
  std::uint32_t line = 0;
  std::uint32_t column = 0;  ///< In bytes.
  friend bool operator==(const Place&, const Place&) { return true; }
};

// Values.

/// A field's value, or a pattern for it.
struct Value {
  enum class Kind : std::uint8_t {
    kAny,       ///< `*`
    kNumber,    ///< `7`, `-7`, `0x1f`
    kRange,     ///< `5..9`: a number from `number` to `max`; `$t+5..$t+9`, `$t+5`: `text` names t,
                ///< and both are counted from what it is bound to
    kReal,      ///< `0.5`, `nan`, `-inf`; `text` as it is written
    kNames,     ///< `temp`, `light|temp`; `text`: an enumerator, or bits of a mask
    kBytes,     ///< `x0a0b`; `text` holds the bytes themselves
    kText,      ///< `"OPEN_DOOR"`; the same, shown as text
    kVariable,  ///< `$q`; `text` is the name without the dollar
    kAddress,   ///< `11:5`; items: pid and devid, each kNumber, kNames, kVariable or kAny
    kChannel,   ///< `2->1`; items: source and destination devid, of the same kinds
    kList,      ///< `[1 2 3]`; items without lists in them
  };

  Kind kind = Kind::kAny;
  bool negated = false;  ///< `!x`: anything but x.
  bool hex = false;      ///< kNumber: written as 0x.
  std::int64_t number = 0;
  std::int64_t max = 0;
  std::string text;
  std::vector<Value> items;

  static Value any() { return {}; }
  static Value of(std::int64_t number);
  static Value range(std::int64_t min, std::int64_t max);
  /// From min to max beyond the variable's value.
  static Value range(std::string_view variable, std::int64_t min, std::int64_t max);
  /// As short as binary32 allows.
  static Value real(float number);
  /// "temp" or "light|temp".
  static Value names(std::string_view names);
  static Value bytes(std::string_view raw);
  static Value quoted(std::string_view raw);
  static Value variable(std::string_view name);
  static Value address(Value pid, Value devid);
  static Value channel(Value source, Value destination);
  /// With the names of reserved devids and pids: `11:null`, `11:all`, `local:5`.
  static Value address(std::uint16_t pid, std::uint16_t devid);
  /// Source devid in the upper 16 bits, as in channel ids.
  static Value channel(std::uint32_t id);
  static Value list(std::vector<Value> items);
  static Value but(Value value);  ///< `!value`

  bool is(Kind k) const { return kind == k; }
  friend bool operator==(const Value&, const Value&) = default;
};

/// `path=value`. The path is dotted as decoding shows it ("payload.body.updates[0].value") or an
/// unambiguous tail of that; an empty path is a positional argument of an application message.
struct FieldValue {
  std::string path;
  Value value;
  Place place;
  friend bool operator==(const FieldValue&, const FieldValue&) = default;
};

/// A message, or a pattern for one.
struct Message {
  /// The form of the fields: `join`, `join(*)` or `join(seq_num=$q ...)`. The first two are the
  /// same for messages that have fields: any of that name.
  enum class Form : std::uint8_t { kBare, kAny, kFields };

  std::string name = "*";  ///< From the wire spec or the application table; `*`: any message.
  Form form = Form::kBare;
  bool open = false;  ///< `...`: fields that are not given are free.
  std::vector<FieldValue> fields;
  Place place;

  static Message any() { return {}; }
  /// Makes a message; add fields with `with`.
  static Message named(std::string_view name);
  Message&& with(std::string_view path, Value value) &&;
  Message& with(std::string_view path, Value value) &;

  /// Returns the value given for exactly this path, or null.
  const Value* find(std::string_view path) const;
  friend bool operator==(const Message&, const Message&) = default;
};

/// `am=2->1`: AM source and destination, each kNumber, kNames (`all`), kVariable or kAny; `!` too.
struct AmAddresses {
  Value source;
  Value dest;
  friend bool operator==(const AmAddresses&, const AmAddresses&) = default;
};

/// An active message as it travels on every link.
struct AmFrame {
  std::uint16_t dest = 0;
  std::uint16_t src = 0;
  std::uint8_t group = 0;
  std::uint8_t type = 0;
  std::vector<std::uint8_t> payload;
  /// A serial packet that is no active message: all its bytes, in place of the rest.
  std::vector<std::uint8_t> packet = {};
  friend bool operator==(const AmFrame&, const AmFrame&) = default;
};
constexpr std::uint16_t kAmAll = 0xFFFF;

/// Returns the serial forwarder packet: dispatch 00, AM header, payload.
std::vector<std::uint8_t> packet_of(const AmFrame& frame);
/// Parses such a packet. Returns false for other bytes, wrong lengths included.
bool parse_packet(std::string_view bytes, AmFrame& out);

// Lines.

/// A value that is mostly absent, and then takes no more than a pointer: a file may have any number
/// of lines.
template <class T>
class Rare {
 public:
  Rare() = default;
  Rare(T value) : value_(std::make_unique<T>(std::move(value))) {}
  Rare(const Rare& other) : value_(other ? std::make_unique<T>(*other) : nullptr) {}
  Rare(Rare&&) = default;
  Rare& operator=(Rare other) {
    value_ = std::move(other.value_);
    return *this;
  }
  void reset() { value_.reset(); }
  explicit operator bool() const { return value_ != nullptr; }
  T& operator*() { return *value_; }
  const T& operator*() const { return *value_; }
  T* operator->() { return value_.get(); }
  const T* operator->() const { return value_.get(); }
  friend bool operator==(const Rare& a, const Rare& b) { return a && b ? *a == *b : !a && !b; }

 private:
  std::unique_ptr<T> value_;
};

/// The role of a line's message.
enum class Op : std::uint8_t {
  kGiven,    ///< `<`: given to the node.
  kEmits,    ///< `>`: the node must emit it.
  kMustNot,  ///< `!>`: the node must not emit it.
  kMay,      ///< `?>`: the node may emit it, once for each such line; `!>` lines do not see it.
  kLost,     ///< The link loses it.
  kDup,      ///< The link doubles it.
};
std::string_view op_text(Op op);
constexpr bool is_fault(Op op) { return op == Op::kLost || op == Op::kDup; }

/// `4*join_period` in a time: so many times a parameter of the line's node.
struct Term {
  std::int64_t factor = 1;  ///< Below 0 after a minus sign.
  ParameterId parameter = ParameterId::kResponse;
  friend bool operator==(const Term&, const Term&) = default;
};

/// A time in ticks of the file: exactly `from`, or from `from` to `to`, both included. Parameters
/// come on top of these.
struct Time {
  enum class Base : std::uint8_t {
    kPrevious,  ///< `5`, `0..50`: after the line that was matched last.
    kLabel,     ///< `a+10`, `a+0..50`: after the line with that label.
    kStart,     ///< `@1234`, `@10..20`: since the start of the case; logs have these.
  };
  Base base = Base::kPrevious;
  std::int64_t from = 0;
  std::int64_t to = 0;
  std::string label;
  std::vector<Term> from_terms = {};
  std::vector<Term> to_terms = {};

  static Time at(std::int64_t ticks) { return {Base::kStart, ticks, ticks, {}}; }
  static Time after(std::int64_t ticks) { return {Base::kPrevious, ticks, ticks, {}}; }
  static Time after(std::string_view label, std::int64_t from, std::int64_t to) {
    return {Base::kLabel, from, to, std::string(label)};
  }
  bool exact() const { return from == to && from_terms == to_terms; }
  friend bool operator==(const Time&, const Time&) = default;
};

/// One line of a case.
struct Line {
  std::string label;  ///< Empty: none.
  Time time;
  std::string node;  ///< `*`: any node; empty for the faults of a link.
  Op op = Op::kGiven;
  std::string link;  ///< rA, serA, peis, app, power; `*`: any.
  Rare<AmAddresses> am;
  Message message;
  std::vector<std::string> requirements;  ///< "J4-SEQ", or "J4" for the family.
  /// The exact serial forwarder packet. In a stimulus it is what the node gets.
  Rare<std::string> bytes;
  std::string comment;
  Place place;
  friend bool operator==(const Line&, const Line&) = default;
};

// Headers.

/// RUBICON's. Another protocol's have the numbers of their places in its list.
enum class Role : std::uint8_t { kMote, kSink, kBaseStation };
enum class LinkKind : std::uint8_t { kRadio, kSerial, kPeis, kApp, kPower, kAny };
enum class Tick : std::uint8_t { kBinaryMs, kMs, kUs };
std::string_view role_text(Role role);
/// Returns the role of the protocol in use that has this name.
std::optional<Role> find_role(std::string_view name);
std::string_view tick_text(Tick tick);
std::string_view link_text(LinkKind kind);
/// Returns ticks in a second: 1024, 1000 or 1000000.
std::uint32_t ticks_per_second(Tick tick);

struct VersionHeader {
  std::int64_t version = 1;
  friend bool operator==(const VersionHeader&, const VersionHeader&) = default;
};
struct ProfileHeader {
  std::string name = "paper";  ///< Or "deployed", for RUBICON.
  friend bool operator==(const ProfileHeader&, const ProfileHeader&) = default;
};
struct TickHeader {
  Tick tick = Tick::kBinaryMs;
  friend bool operator==(const TickHeader&, const TickHeader&) = default;
};
struct NodeHeader {
  std::string name;
  Role role = Role::kMote;
  std::optional<std::uint16_t> id;      ///< TinyOS id; motes and sinks have one.
  std::optional<std::uint16_t> island;  ///< For sinks and base stations when they start.
  bool iut = false;                     ///< Under test.
  bool whole = false;                   ///< A log has all that it got and did, in the given values.
  Statement stated = {};                ///< Other parameters are the profile's.
  friend bool operator==(const NodeHeader&, const NodeHeader&) = default;
};
struct LinkHeader {
  std::string name;
  LinkKind kind = LinkKind::kRadio;  ///< kRadio, kSerial or kPeis.
  std::vector<std::string> nodes;
  friend bool operator==(const LinkHeader&, const LinkHeader&) = default;
};
struct SeedHeader {
  std::uint64_t seed = 0;
  friend bool operator==(const SeedHeader&, const SeedHeader&) = default;
};
/// Implementations that state other values are not tried by the case.
struct ForHeader {
  std::vector<StatedRange> values;  ///< Each parameter at most once.
  friend bool operator==(const ForHeader&, const ForHeader&) = default;
};
struct NoteHeader {
  std::string text;
  friend bool operator==(const NoteHeader&, const NoteHeader&) = default;
};
struct Header {
  std::variant<VersionHeader, ProfileHeader, TickHeader, NodeHeader, LinkHeader, SeedHeader,
               ForHeader, NoteHeader>
      what;
  std::string comment;  ///< Not of a note, which is text to the end of its line.
  Place place;
  friend bool operator==(const Header&, const Header&) = default;
};

// The file.

/// Lines with nothing in them.
struct Blank {
  std::size_t lines = 1;
  friend bool operator==(const Blank&, const Blank&) = default;
};
/// A line that is only a comment.
struct Comment {
  char marker = '#';  ///< '#' or ';'.
  bool indented = false;
  std::string text;  ///< After the marker.
  friend bool operator==(const Comment&, const Comment&) = default;
};

/// A value that its copies share: a case is copied for each run of it, with other headers.
template <class T>
class Shared {
 public:
  explicit Shared(T&& value) : value_(std::make_shared<T>(std::move(value))) {}
  const T& get() const { return *value_; }
  /// Returns one that no copy shares.
  T& own() {
    if (value_.use_count() > 1) value_ = std::make_shared<T>(*value_);
    return *value_;
  }
  friend bool operator==(const Shared& a, const Shared& b) { return *a.value_ == *b.value_; }

 private:
  std::shared_ptr<T> value_;
};

/// A line of a file, or several blank ones. Most kinds are far larger than a blank or a comment, of
/// which a file may have any number, so they are held apart.
class Item {
 public:
  Item(Blank what) : what_(what) {}
  Item(Comment what) : what_(std::move(what)) {}
  Item(Header&& what) : what_(Shared(std::move(what))) {}
  Item(Line&& what) : what_(Shared(std::move(what))) {}
  friend bool operator==(const Item&, const Item&) = default;

  /// Returns it as the kind T; null if it is another.
  template <class T>
  const T* as() const {
    if constexpr (std::is_same_v<T, Header> || std::is_same_v<T, Line>) {
      const auto* const shared = std::get_if<Shared<T>>(&what_);
      return shared == nullptr ? nullptr : &shared->get();
    } else {
      return std::get_if<T>(&what_);
    }
  }
  /// The same, to be changed.
  template <class T>
  T* as() {
    if constexpr (std::is_same_v<T, Header> || std::is_same_v<T, Line>) {
      auto* const shared = std::get_if<Shared<T>>(&what_);
      return shared == nullptr ? nullptr : &shared->own();
    } else {
      return std::get_if<T>(&what_);
    }
  }

 private:
  std::variant<Blank, Comment, Shared<Header>, Shared<Line>> what_;
};

struct Case {
  std::string name;  ///< Stable: words of letters, digits, `_` and `-`, joined by dots.
  std::string comment;
  std::vector<Item> items;
  Place place;

  Case() = default;
  explicit Case(std::string_view case_name) : name(case_name) {}
  void add(Line line) { items.emplace_back(std::move(line)); }
  /// Returns the lines in order; pointers into `items`.
  std::vector<const Line*> lines() const&;
  std::vector<const Line*> lines() const&& = delete;
  friend bool operator==(const Case&, const Case&) = default;
};

struct File {
  std::vector<Item> head;  ///< Before the first case.
  std::vector<Case> cases;

  /// Returns a file with the headers that every file begins with; an empty profile has none.
  static File begin(std::string_view profile, Tick tick = Tick::kBinaryMs);
  File& node(NodeHeader header);
  File& header(Header header);
  const Case* find(std::string_view case_name) const;
  friend bool operator==(const File&, const File&) = default;
};

/// The headers that apply to one case: its own where it has some of that kind, else the file's.
struct Scope {
  std::string profile = "paper";
  Tick tick = Tick::kBinaryMs;
  std::uint64_t seed = 0;
  std::vector<NodeHeader> nodes;
  std::vector<LinkHeader> links;

  const NodeHeader* node(std::string_view name) const;
  /// Returns the kind of a link by %link, else by its name: r..., ser..., peis, app, power, `*`.
  std::optional<LinkKind> link(std::string_view name) const;
};
Scope scope_of(const File& file, const Case& one);

/// Returns "J4-SEQ"; empty for ReqId::kNone.
std::string_view requirement_text(ReqId id);
/// Returns the id; ReqId::kNone for a family ("J4") and for unknown rules.
ReqId requirement_id(std::string_view text);

}  // namespace rubric::trace
