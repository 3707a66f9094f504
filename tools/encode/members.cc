#include "tools/encode/members.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "codec/reflect/encode_number.h"
#include "codec/reflect/fault_text.h"
#include "tools/encode/record.h"

namespace rubric::encode {
namespace {

using nlohmann::json;
using reflect::Value;

// Frames nest a handful of levels; without a bound, a hostile line would overflow the stack.
constexpr std::size_t kMaxDepth = 64;

/// Builds the tree while the parser goes along.
class Builder final : public nlohmann::json_sax<json> {
 public:
  Value take() { return std::move(root_); }

  bool null() override { return put(Value{}); }
  bool boolean(bool value) override {
    Value made = Value::of_integer(value);
    made.kind = Value::Kind::kBool;
    return put(std::move(made));
  }
  bool number_integer(number_integer_t value) override {
    // Only called for numbers with a minus: an integer would lose that of -0.
    return put(value == 0 ? Value::of_real("-0") : Value::of_integer(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    if (value > static_cast<number_unsigned_t>(INT64_MAX)) {
      return put(Value::of_real(std::to_string(value)));
    }
    return put(Value::of_integer(static_cast<std::int64_t>(value)));
  }
  bool number_float(number_float_t, const string_t& text) override {
    return put(Value::of_real(text));
  }
  bool string(string_t& value) override { return put(Value::of_string(value)); }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override { return open(Value::of_object()); }
  bool key(string_t& name) override {
    if (open_.back()->find(name)) throw JsonError("the key \"" + name + "\" is given twice", 1);
    open_.back()->keys.push_back(name);
    return true;
  }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(Value::of_array({})); }
  bool end_array() override { return close(); }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 5: ...": the rest will do.
    std::string text = error.what();
    const std::size_t colon = text.find(": ");
    if (colon != std::string::npos) text.erase(0, colon + 2);
    throw JsonError("no JSON: " + text, position);
  }

 private:
  bool put(Value value) {
    if (open_.empty()) {
      root_ = std::move(value);
    } else {
      open_.back()->items.push_back(std::move(value));
    }
    return true;
  }
  bool open(Value value) {
    if (open_.size() == kMaxDepth) throw JsonError("nested deeper than any frame", 1);
    put(std::move(value));
    open_.push_back(open_.empty() ? &root_ : &open_.back()->items.back());
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  Value root_;
  std::vector<Value*> open_;
};

}  // namespace

using reflect::Value;
using reflect::value_text;

const Value* given(const Value& object, std::string_view key) {
  const Value* value = object.find(key);
  return value && !value->is(Value::Kind::kNull) ? value : nullptr;
}

std::string_view text_of(const Value& object, std::string_view key) {
  const Value* value = given(object, key);
  if (!value) return {};
  if (value->is(Value::Kind::kString)) return value->text;
  throw RecordError(std::string(key), "expected a string, given " + value_text(*value));
}

std::optional<std::int64_t> integer_of(const Value& object, std::string_view path,
                                       std::string_view key, std::int64_t max) {
  const Value* value = given(object, key);
  if (!value) return std::nullopt;
  if (value->is(Value::Kind::kInteger) && value->integer >= 0 && value->integer <= max) {
    return value->integer;
  }
  throw RecordError(
      std::string(path) + (path.empty() ? "" : ".") + std::string(key),
      "expected a number from 0 to " + std::to_string(max) + ", given " + value_text(*value));
}

std::int64_t time_of(const Value* value) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  if (!value || value->is(Value::Kind::kNull)) return kNoTime;
  std::string text = value->text;
  if (value->is(Value::Kind::kInteger)) text = std::to_string(value->integer);
  const auto wrong = [&] {
    return RecordError("time",
                       "expected seconds as a decimal number with at most nine digits "
                       "after the point, or null, given " +
                           value_text(*value));
  };
  if (!value->is(Value::Kind::kInteger) && !value->is(Value::Kind::kReal)) throw wrong();
  if (text.find_first_of("eE") != std::string::npos) {
    // Other programs write small numbers so; good for a double's digits, which is all they had.
    const double exact = std::strtod(text.c_str(), nullptr) * static_cast<double>(kSecond);
    if (!(std::abs(exact) < static_cast<double>(INT64_MAX) / 2)) throw wrong();
    return std::llround(exact);
  }
  const bool negative = text.starts_with('-');
  const char* at = text.data() + negative;
  const char* const end = text.data() + text.size();
  std::int64_t seconds = 0;
  auto read = std::from_chars(at, end, seconds);
  if (read.ec != std::errc{} || seconds < 0 || seconds > INT64_MAX / kSecond - 1) throw wrong();
  std::int64_t nanoseconds = 0;
  if (read.ptr != end) {
    if (*read.ptr != '.') throw wrong();
    std::int64_t unit = kSecond / 10;
    for (const char* digit = read.ptr + 1; digit != end; ++digit, unit /= 10) {
      if (*digit < '0' || *digit > '9' || (unit == 0 && *digit != '0')) throw wrong();
      nanoseconds += (*digit - '0') * unit;
    }
  }
  const std::int64_t total = seconds * kSecond + nanoseconds;
  return negative ? -total : total;
}

Framing framing_of(const Value& line) {
  const std::string_view name = text_of(line, "framing");
  if (name == "hdlc") return Framing::kHdlc;
  if (name == "sf") return Framing::kSf;
  if (name == "radio") return Framing::kRadio;
  if (name == "bare") return Framing::kBare;
  throw RecordError("framing", "expected \"hdlc\", \"sf\", \"radio\" or \"bare\", given " +
                                   (name.empty() ? "none" : '"' + std::string(name) + '"'));
}

Direction direction_of(const Value& line) {
  const std::string_view name = text_of(line, "direction");
  if (name.empty()) return Direction::kUnknown;
  if (name == "inbound") return Direction::kInbound;
  if (name == "outbound") return Direction::kOutbound;
  throw RecordError("direction", "expected \"inbound\", \"outbound\" or null, given \"" +
                                     std::string(name) + '"');
}

Fault fault_of(const Value& line) {
  const Value* error = given(line, "error");
  if (!error) return Fault::kNone;
  if (!error->is(Value::Kind::kObject)) {
    throw RecordError("error", "expected an object or null, given " + value_text(*error));
  }
  const std::string_view name = text_of(*error, "fault");
  if (const auto fault = reflect::find_fault(name)) return *fault;
  throw RecordError("error.fault", "expected the name of a fault such as \"" +
                                       std::string(reflect::fault_name(Fault::kCrc)) +
                                       "\", given \"" + std::string(name) + '"');
}

bool is_framing_fault(Fault fault) { return fault >= Fault::kCrc; }

Value parse_json(std::string_view text) {
  Builder builder;
  json::sax_parse(text, &builder);
  return builder.take();
}

}  // namespace rubric::encode
