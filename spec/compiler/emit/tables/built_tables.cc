#include "spec/compiler/emit/tables/built_tables.h"

#include <algorithm>
#include <memory>
#include <type_traits>

#include "spec/compiler/emit/tables/routes.h"

namespace rubricc {
namespace {

namespace reflect = rubric::reflect;

reflect::Op load(const Field& field) {
  if (field.width_bytes == 1) return reflect::Op::kLoadU8;
  if (field.width_bytes == 2) {
    return field.little_endian ? reflect::Op::kLoadLe16 : reflect::Op::kLoadBe16;
  }
  return field.little_endian ? reflect::Op::kLoadLe32 : reflect::Op::kLoadBe32;
}

/// Returns the step of an operator or a constant; operators have one order in both enums.
reflect::Op op_of(ExprOp op) {
  if (op < ExprOp::kAdd) return reflect::Op::kConst;
  const bool late = op >= ExprOp::kBitAnd;
  const auto first = static_cast<int>(late ? ExprOp::kBitAnd : ExprOp::kAdd);
  const auto to = static_cast<int>(late ? reflect::Op::kBitAnd : reflect::Op::kAdd);
  return static_cast<reflect::Op>(static_cast<int>(op) - first + to);
}
static_assert(static_cast<int>(ExprOp::kNot) - static_cast<int>(ExprOp::kAdd) ==
              static_cast<int>(reflect::Op::kNot) - static_cast<int>(reflect::Op::kAdd));
static_assert(static_cast<int>(ExprOp::kSelect) - static_cast<int>(ExprOp::kBitAnd) ==
              static_cast<int>(reflect::Op::kSelect) - static_cast<int>(reflect::Op::kBitAnd));

std::uint16_t from_of(const Expr& expr) { return static_cast<std::uint16_t>(expr.from + 1); }

/// Appends a number of bits: its bytes joined, without the bits above it and below it.
void append_bits(const Expr& expr, std::vector<reflect::ExprStep>& out) {
  const Field& field = *expr.field;
  const auto constant = [&](std::int64_t value, reflect::Op op) {
    out.push_back({reflect::Op::kConst, static_cast<std::int32_t>(value)});
    out.push_back({op, 0});
  };
  for (int i = 0; i < field.width_bytes; ++i) {
    const int byte = field.little_endian ? field.width_bytes - 1 - i : i;
    if (i > 0) constant(256, reflect::Op::kMul);
    out.push_back(
        {reflect::Op::kLoadU8, static_cast<std::int32_t>(expr.offset_bytes + byte), from_of(expr)});
    const int bits = field.bit_width + field.bit_shift - 8 * (field.width_bytes - 1);
    if (i == 0 && bits < 8) constant(std::int64_t{1} << bits, reflect::Op::kMod);
    if (i > 0) out.push_back({reflect::Op::kAdd, 0});
  }
  constant(std::int64_t{1} << field.bit_shift, reflect::Op::kDiv);
}

void append(const Expr& expr, std::vector<reflect::ExprStep>& out) {
  if (expr.field != nullptr && expr.field->bit_width > 0) return append_bits(expr, out);
  for (const auto& operand : expr.operands) append(*operand, out);
  if (expr.param >= 0) return out.push_back({reflect::Op::kParam, expr.param});
  const bool is_field = expr.op == ExprOp::kField;
  out.push_back({is_field ? load(*expr.field) : op_of(expr.op),
                 static_cast<std::int32_t>(is_field ? expr.offset_bytes : expr.value),
                 from_of(expr)});
}

rubric::ReqId rule_of(const std::string& id) {
  return id.empty() ? rubric::ReqId::kNone : rubric::rule_number(id.c_str());
}

}  // namespace

std::vector<reflect::ExprStep> postfix(const Expr& expr) {
  std::vector<reflect::ExprStep> out;
  append(expr, out);
  return out;
}

class BuiltTables::Builder {
 public:
  explicit Builder(BuiltTables& tables) : kept_(tables.kept_), fields_(&tables.fields_) {}

  /// Makes what types refer to, also those of specs that are built before.
  void begin(const Spec& spec) {
    for (const auto& one : spec.enums) enumeration(*one);
    for (const auto& one : spec.types) {
      if (one->is_mask) masks_[one.get()] = mask(*one);
    }
  }

  BuiltSpec build(const Spec& spec) {
    std::vector<const reflect::EnumTable*> enums;
    std::vector<const reflect::MaskTable*> masks;
    std::vector<const reflect::Type*> types;
    std::vector<reflect::Carrier> carriers;
    for (const auto& one : spec.enums) enums.push_back(enums_.at(one.get()));
    for (const auto& one : spec.types) {
      if (one->is_mask) {
        masks.push_back(masks_.at(one.get()));
        continue;
      }
      types.push_back(type_of(one.get()));
      if (!one->carrier.empty()) carriers.push_back({text(one->carrier), types.back()});
    }
    const reflect::Protocol protocol{text(spec.id),  text(spec.title), list(types), count(types),
                                     list(enums),    count(enums),     list(masks), count(masks),
                                     list(carriers), count(carriers)};
    return {single(protocol), routes(spec)};
  }

 private:
  template <class T>
  const T* list(const std::vector<T>& values) {
    if (values.empty()) return nullptr;
    const auto kept = std::make_shared<const std::vector<T>>(values);
    kept_.push_back(kept);
    return kept->data();
  }
  /// The same for what has fields. These lie side by side, as those of built-in tables do, so that
  /// what belongs to a field is found by its address (tools/format/json_nodes.h).
  template <class T>
  const T* near(const std::vector<T>& values) {
    static_assert(std::is_trivially_destructible_v<T>);
    if (values.empty()) return nullptr;
    T* const out = std::pmr::polymorphic_allocator<T>(fields_).allocate(values.size());
    std::uninitialized_copy(values.begin(), values.end(), out);
    return out;
  }
  template <class T>
  const T* single(const T& value) {
    return list(std::vector<T>{value});
  }
  const char* text(const std::string& value) {
    const auto kept = std::make_shared<const std::string>(value);
    kept_.push_back(kept);
    return kept->c_str();
  }
  template <class T>
  static std::uint16_t count(const std::vector<T>& values) {
    return static_cast<std::uint16_t>(values.size());
  }
  template <class T>
  static std::uint8_t few(const std::vector<T>& values) {
    return static_cast<std::uint8_t>(values.size());
  }

  void enumeration(const Enum& one) {
    std::vector<reflect::EnumEntry> entries;
    for (const EnumEntry& entry : one.entries) {
      entries.push_back({static_cast<std::uint32_t>(entry.value), text(entry.name)});
    }
    enums_[&one] = single<reflect::EnumTable>({text(one.id), list(entries), count(entries)});
  }

  const reflect::MaskTable* mask(const Type& one) {
    std::vector<const char*> bits;
    for (auto bit = one.bits.rbegin(); bit != one.bits.rend(); ++bit) {
      bits.push_back(bit->unnamed ? nullptr : text(bit->name));
    }
    return single<reflect::MaskTable>({text(one.name), list(bits), few(bits)});
  }

  reflect::Expr expr(const ExprPtr& tree) {
    if (!tree) return {};
    const auto steps = postfix(*tree);
    const bool floats =
        std::any_of(steps.begin(), steps.end(), [](const auto& step) { return step.from != 0; });
    return {list(steps), few(steps), floats};
  }

  reflect::Valid valid(const Field& field) {
    if (!field.valid) return {reflect::ValidKind::kAny, 0, 0, nullptr, 0};
    const Valid& rule = *field.valid;
    if (rule.one_of.empty()) return {reflect::ValidKind::kRange, *rule.min, *rule.max, nullptr, 0};
    return {reflect::ValidKind::kOneOf, 0, 0, list(rule.one_of), few(rule.one_of)};
  }

  const reflect::Type* type_of(const Type* one) {
    if (one == nullptr) return nullptr;
    const auto found = types_.find(one);
    return found != types_.end() ? found->second : types_[one] = type(*one);
  }

  const reflect::Switch* choice(const Field& field) {
    if (!field.choice) return nullptr;
    std::vector<reflect::SwitchCase> cases;
    for (const SwitchCase& one : field.choice->cases) {
      cases.push_back({one.key, type_of(one.type), arguments(one.type, one.arguments)});
    }
    const auto& otherwise = field.choice->otherwise;
    const Type* const rest = otherwise ? otherwise->type : nullptr;
    return single<reflect::Switch>({expr(field.choice->key), list(cases), count(cases),
                                    type_of(rest),
                                    rest ? arguments(rest, otherwise->arguments) : nullptr});
  }

  const reflect::Argument* arguments(const Type* type, const std::vector<ExprPtr>& given) {
    std::vector<reflect::Argument> out;
    for (std::size_t i = 0; i < given.size(); ++i) {
      const Interval range = type->params[i].range;
      out.push_back({expr(given[i]), range.min, range.max});
    }
    return list(out);
  }

  const reflect::Unit* unit(const Field& field) {
    if (!field.unit) return nullptr;
    return single<reflect::Unit>({text(field.unit->symbol), field.unit->scale, field.unit->offset});
  }

  const reflect::Text* characters(const Field& field) {
    if (!field.text) return nullptr;
    const Text& from = *field.text;
    return single<reflect::Text>({from.encoding, static_cast<std::int16_t>(from.terminator),
                                  static_cast<std::int16_t>(from.padding), from.may_lack_its_end,
                                  from.charset.empty() ? nullptr : text(from.charset),
                                  static_cast<std::uint8_t>(from.unit)});
  }

  reflect::Field field(const Field& one) {
    const std::string key = "\"" + one.name + "\":";
    const bool is_struct = one.kind == ValueKind::kStruct;
    return {text(one.name),
            text(key),
            static_cast<std::uint8_t>(key.size()),
            one.bit_width > 0 ? reflect::Kind::kBits : one.kind,
            static_cast<std::uint8_t>(one.width_bytes),
            one.little_endian,
            one.repeat,
            one.extent,
            static_cast<std::int32_t>(one.fixed_offset),
            valid(one),
            one.expect.value_or(-1),
            one.enumeration ? enums_.at(one.enumeration) : nullptr,
            one.kind == ValueKind::kMask ? masks_.at(one.type) : nullptr,
            is_struct ? type_of(one.type) : nullptr,
            choice(one),
            expr(one.size),
            expr(one.count),
            expr(one.condition),
            rule_of(one.requirement),
            unit(one),
            text(one.doc),
            characters(one),
            static_cast<std::uint8_t>(one.bit_width),
            static_cast<std::uint8_t>(one.bit_shift),
            expr(one.until),
            is_struct && one.type ? arguments(one.type, one.arguments) : nullptr};
  }

  const reflect::Type* type(const Type& one) {
    std::vector<reflect::Field> fields;
    std::vector<reflect::Interpretation> interpretations;
    for (const auto& each : one.fields) fields.push_back(field(*each));
    for (const auto& each : one.instances) {
      if (each->is_peek || each->overlays < 0) continue;
      interpretations.push_back({field(*each), static_cast<std::uint16_t>(each->overlays)});
    }
    const std::int64_t am_type = one.am_types.empty() ? -1 : one.am_types.front();
    std::vector<const char*> params;
    for (const Param& param : one.params) params.push_back(text(param.id));
    return single<reflect::Type>(
        {text(one.id), text(one.name), near(fields), count(fields), near(interpretations),
         count(interpretations), one.min_size, one.max_size, static_cast<std::int32_t>(am_type),
         rule_of(one.requirement), text(one.doc), text(one.doc_ref), list(params), few(params)});
  }

  const reflect::RouteTable* routes(const Spec& spec) {
    std::vector<reflect::Route> out;
    for (const Route& one : routes_of(spec)) {
      std::vector<reflect::RouteChoice> choices;
      std::vector<reflect::RouteLength> lengths;
      for (const RouteNumber& number : one.choices) {
        choices.push_back({static_cast<std::uint16_t>(number.offset),
                           static_cast<std::uint8_t>(number.width_bytes), number.little_endian,
                           static_cast<std::uint32_t>(number.value)});
      }
      for (const RouteNumber& number : one.lengths) {
        lengths.push_back({static_cast<std::uint16_t>(number.offset),
                           static_cast<std::uint8_t>(number.width_bytes), number.little_endian,
                           static_cast<std::uint16_t>(number.value)});
      }
      out.push_back({text(one.carrier), types_.at(one.type), static_cast<std::uint16_t>(one.offset),
                     one.room, list(choices), few(choices), list(lengths), few(lengths)});
    }
    const auto has_carrier = [](const auto& type) { return !type->carrier.empty(); };
    const bool bare = std::none_of(spec.types.begin(), spec.types.end(), has_carrier);
    for (const auto& one : spec.types) {
      // What nothing chooses comes as it is: a beacon, or all messages where there are no frames.
      const bool link = one->carrier == "radio_beacon" || one->carrier == "radio_command";
      if (one->is_mask || !(bare || link) || !one->params.empty()) continue;
      const char* carrier = bare ? "bare" : text(one->carrier);
      out.push_back({carrier, types_.at(one.get()), 0, one->max_size, nullptr, 0, nullptr, 0});
    }
    return single<reflect::RouteTable>({list(out), count(out)});
  }

  std::vector<std::shared_ptr<const void>>& kept_;
  std::pmr::memory_resource* fields_;
  std::map<const Enum*, const reflect::EnumTable*> enums_;
  std::map<const Type*, const reflect::MaskTable*> masks_;
  std::map<const Type*, const reflect::Type*> types_;
};

BuiltTables::BuiltTables(const Model& model) {
  Builder builder(*this);
  for (const auto& spec : model.specs) builder.begin(*spec);
  for (const auto& spec : model.specs) specs_[spec->id] = builder.build(*spec);
}

BuiltSpec BuiltTables::of(const std::string& id) const {
  const auto found = specs_.find(id);
  return found == specs_.end() ? BuiltSpec{} : found->second;
}

}  // namespace rubricc
