// The only translation unit that sees nlohmann-json: it costs seconds to compile.
#include "tools/encode/json.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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

Value parse_json(std::string_view text) {
  Builder builder;
  json::sax_parse(text, &builder);
  return builder.take();
}

}  // namespace rubric::encode
