#include "conformance/test/runner/output_index.h"

#include <algorithm>
#include <functional>
#include <string>

#include "conformance/trace/match.h"
#include "conformance/trace/protocol.h"

namespace rubric::runner {
namespace {

using trace::Concrete;
using trace::Leaf;
using trace::Value;

constexpr std::uint64_t kAny = 1;  // Keys begin with one of these.
constexpr std::uint64_t kOfProtocol = 2;
constexpr std::uint64_t kNamed = 3;
constexpr std::uint64_t kMatchable = 4;
constexpr std::uint64_t kSource = 5;
constexpr std::uint64_t kDest = 6;
constexpr std::uint64_t kPacket = 7;

std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t kMixer = 0x9E3779B97F4A7C15;
  a = (a ^ b) * kMixer;
  return a ^ a >> 32;
}
std::uint64_t mixed(std::uint64_t a, std::string_view text) {
  return mixed(a, std::hash<std::string_view>()(text));
}
std::uint64_t key_of_number(std::uint64_t path, std::int64_t number) {
  return mixed(path, static_cast<std::uint64_t>(number) + 1);
}

std::uint64_t key_of_path(std::string_view message, std::string_view path) {
  return mixed(mixed(kMatchable, message), path);
}
std::uint64_t key_of_item(std::uint64_t path, std::size_t item) {
  return mixed(path, std::uint64_t{1} << 40 | item);
}

std::uint64_t key_of_packet(const trace::AmFrame& frame) {
  const std::vector<std::uint8_t> packet = trace::packet_of(frame);
  const std::string_view bytes(reinterpret_cast<const char*>(packet.data()), packet.size());
  return mixed(kPacket, bytes);
}

// Returns the value that is meant, if there is one; else null.
const Value* meant(const Value& value, const trace::Bindings& bindings) {
  if (value.negated) return nullptr;
  return value.is(Value::Kind::kVariable) ? bindings.find(value.text) : &value;
}

// Gives the keys of all outputs that have this value.
template <class Take>
void each_key_of_value(std::uint64_t path, const Value& given, const trace::Bindings& bindings,
                       Take take) {
  const Value* const value = meant(given, bindings);
  if (value == nullptr) return;
  if (value->is(Value::Kind::kNumber)) take(path, key_of_number(path, value->number));
  if (value->is(Value::Kind::kBytes) || value->is(Value::Kind::kText)) {
    take(path, mixed(path, value->text));
  }
  for (std::size_t i = 0; i < value->items.size(); ++i) {
    each_key_of_value(key_of_item(path, i), value->items[i], bindings, take);
  }
}

}  // namespace

template <class Take>
void OutputIndex::each_key_of_leaf(Key path, const Leaf& leaf, Take take) {
  switch (leaf.domain.kind) {
    case trace::Domain::Kind::kNumber: return take(key_of_number(path, leaf.number));
    case trace::Domain::Kind::kReal: vague_.insert(path); return;
    case trace::Domain::Kind::kBytes: break;
  }
  take(mixed(path, leaf.bytes));
  if (leaf.text && *leaf.text != leaf.bytes) take(mixed(path, *leaf.text));
}

template <class Take>
void OutputIndex::each_key_of_fields(const Concrete& message, Take take) {
  for (const Leaf& leaf : message.leaves) {
    each_key_of_leaf(key_of_path(message.name, leaf.path), leaf, take);
    if (leaf.alias.empty()) continue;
    each_key_of_leaf(key_of_path(message.name, leaf.alias), leaf, take);
  }
  for (const trace::Part& part : message.parts) {
    for (const std::string* path : {&part.path, &part.alias}) {
      const Key key = key_of_path(message.name, *path);
      if (path->empty()) continue;
      if (part.kind == trace::Slot::Kind::kStruct) {
        take(mixed(key, part.bytes));
        continue;
      }
      for (std::size_t i = part.first; i < part.end; ++i) {
        each_key_of_leaf(key_of_item(key, i - part.first), message.leaves[i], take);
      }
    }
  }
}

template <class Take>
void OutputIndex::each_key(const Concrete& message, std::string_view link, bool foreign,
                           Take take) {
  for (const std::uint64_t kind : {kAny, kOfProtocol}) {
    if (kind == kOfProtocol && foreign) continue;
    take(mixed(kind, "*"));
    take(mixed(kind, link));
  }
  take(mixed(kNamed, message.name));
  take(mixed(kMatchable, message.name));
  each_key_of_fields(message, take);
  if (!message.frame) return;
  take(key_of_number(kSource, message.frame->src));
  take(key_of_number(kDest, message.frame->dest));
  take(key_of_packet(*message.frame));
  if (message.name == trace::kFrameName) return;
  take(mixed(kMatchable, trace::kFrameName));
  each_key_of_fields(trace::decode_raw(*message.frame), take);
}

void OutputIndex::add(std::uint32_t place, const Concrete& message, std::string_view link,
                      bool foreign) {
  each_key(message, link, foreign, [&](Key key) {
    std::vector<std::uint32_t>& places = buckets_[key].places;
    if (places.empty() || places.back() != place) places.push_back(place);
  });
}

void OutputIndex::remove(std::uint32_t place, const Concrete& message, std::string_view link,
                         bool foreign) {
  each_key(message, link, foreign, [&](Key key) {
    Bucket& bucket = buckets_[key];
    const auto begin = bucket.places.begin() + static_cast<std::ptrdiff_t>(bucket.begin);
    const auto found = std::lower_bound(begin, bucket.places.end(), place);
    if (found == bucket.places.end() || *found != place) return;
    if (found - begin > bucket.places.end() - found) {
      bucket.places.erase(found);
    } else {
      std::move_backward(begin, found, found + 1);
      ++bucket.begin;
    }
  });
}

OutputIndex::Places OutputIndex::at(Key key) const {
  const auto found = buckets_.find(key);
  if (found == buckets_.end()) return {};
  return Places(found->second.places).subspan(found->second.begin);
}

OutputIndex::Places OutputIndex::about(const trace::Line& line) const {
  return at(mixed(line.message.name == "*" ? kOfProtocol : kAny, line.link));
}

OutputIndex::Places OutputIndex::of_its_name(const trace::Line& line) const {
  const Places about = this->about(line);
  const Places named = at(mixed(kNamed, line.message.name));
  return named.size() < about.size() ? named : about;
}

OutputIndex::Places OutputIndex::like(const trace::Line& line,
                                      const trace::Bindings& bindings) const {
  Places least = about(line);
  const auto narrow = [&](Key path, Key key) {
    const Places found = vague_.contains(path) ? least : at(key);
    if (found.size() < least.size()) least = found;
  };
  const trace::Message& message = line.message;
  if (message.name != "*") narrow(0, mixed(kMatchable, message.name));
  if (line.am) {
    each_key_of_value(kSource, line.am->source, bindings, narrow);
    each_key_of_value(kDest, line.am->dest, bindings, narrow);
  }
  if (line.bytes) narrow(0, mixed(kPacket, *line.bytes));
  const trace::Shape* const shape = trace::Schema::get().find(message.name);
  if (message.form != trace::Message::Form::kFields || shape == nullptr) return least;
  try {
    for (const trace::FieldValue& field : trace::with_paths(message, *shape)) {
      each_key_of_value(key_of_path(message.name, field.path), field.value, bindings, narrow);
    }
  } catch (const trace::TraceError&) {  // It matches nothing, and says why.
  }
  return least;
}

}  // namespace rubric::runner
