// A protocol made by hand for tests of the decoder and the encoder: every kind of field that the
// tables can express, in few types.
#pragma once

#include <iterator>

#include "codec/reflect/schema.h"

namespace rubric::reflect::toy {

inline constexpr EnumEntry kColourEntries[] = {{1, "red"}, {2, "green"}, {7, "blue"}};
inline constexpr EnumTable kColour = {"colour", kColourEntries, 3};
inline constexpr const char* kFlagNames[8] = {"up",    "down",  nullptr, nullptr,
                                              nullptr, nullptr, nullptr, "odd"};
inline constexpr MaskTable kFlags = {"flags", kFlagNames, 8};

inline constexpr Unit kMillivolt = {"mV", 0.5, 0};

inline constexpr Valid kAny = {ValidKind::kAny, 0, 0, nullptr, 0};
inline constexpr Expr kNoExpr = {nullptr, 0};

/// Returns a field with the most common defaults; the tests' tables change the rest.
constexpr Field field(const char* name, Kind kind, std::uint8_t width, std::int32_t offset) {
  Field f{};
  f.name = name;
  f.json_key = name;
  f.kind = kind;
  f.width_bytes = width;
  f.repeat = Repeat::kOnce;
  f.extent = Extent::kOwn;
  f.fixed_offset = offset;
  f.valid = kAny;
  f.expect = -1;
  f.size = f.count = f.condition = kNoExpr;
  f.requirement = "WIRE-COMMAND"_rule;
  f.doc = "";
  return f;
}
constexpr Field with_valid(Field f, Valid valid) {
  f.valid = valid;
  return f;
}
constexpr Field with_enum(Field f, const EnumTable& table) {
  f.enumeration = &table;
  return f;
}
constexpr Field with_mask(Field f, const MaskTable& table) {
  f.mask = &table;
  return f;
}
constexpr Field with_condition(Field f, Expr condition) {
  f.condition = condition;
  return f;
}
constexpr Field with_count(Field f, Expr count) {
  f.repeat = Repeat::kCount;
  f.count = count;
  return f;
}
constexpr Field with_size(Field f, Expr size) {
  f.extent = Extent::kSize;
  f.size = size;
  return f;
}
constexpr Field with_type(Field f, const Type& type) {
  f.type = &type;
  return f;
}
constexpr Field with_choice(Field f, const Switch& choice) {
  f.choice = &choice;
  return f;
}
constexpr Field with_expect(Field f, std::int64_t value) {
  f.expect = value;
  return f;
}
constexpr Field to_end(Field f) {
  f.extent = Extent::kToEnd;
  return f;
}
constexpr Field repeat_to_end(Field f) {
  f.repeat = Repeat::kToEnd;
  return f;
}
constexpr Field little(Field f) {
  f.little_endian = true;
  return f;
}
constexpr Field with_unit(Field f, const Unit& unit) {
  f.unit = &unit;
  return f;
}
template <std::size_t N>
constexpr Expr expr(const ExprStep (&steps)[N]) {
  return {steps, static_cast<std::uint8_t>(N)};
}
template <std::size_t N>
constexpr Type type(const char* name, const Field (&fields)[N]) {
  return {name,    name,
          fields,  static_cast<std::uint16_t>(N),
          nullptr, 0,
          0,       UINT32_MAX,
          -1,      "WIRE-CONFIG"_rule,
          "",      ""};
}

// scalars: every number, its enum and mask, and a field that is there only if colour is red.
inline constexpr ExprStep kIsRedSteps[] = {{Op::kLoadU8, 0}, {Op::kConst, 1}, {Op::kEq, 0}};
inline constexpr std::int64_t kFourOrSix[] = {4, 6};
inline constexpr Field kScalarFields[] = {
    with_enum(field("colour", Kind::kUint, 1, 0), kColour),
    with_mask(field("flags", Kind::kMask, 1, 1), kFlags),
    with_unit(little(field("little", Kind::kUint, 2, 2)), kMillivolt),
    field("signed", Kind::kSint, 2, 4),
    little(field("real", Kind::kFloat, 4, 6)),
    with_valid(field("four_or_six", Kind::kUint, 1, 10), {ValidKind::kOneOf, 0, 0, kFourOrSix, 2}),
    with_valid(field("seven", Kind::kUint, 1, 11), {ValidKind::kRange, 7, 7, nullptr, 0}),
    with_expect(field("eight", Kind::kUint, 1, 12), 8),
    with_condition(field("if_red", Kind::kUint, 4, 13), expr(kIsRedSteps)),
};
inline constexpr Type kScalars = type("scalars", kScalarFields);

// pair: the content of arrays and switches.
inline constexpr Field kPairFields[] = {field("a", Kind::kUint, 1, 0),
                                        field("b", Kind::kUint, 1, 1)};
inline constexpr Type kPair = [] {
  Type t = type("pair", kPairFields);
  t.min_size = t.max_size = 2;
  return t;
}();

// arrays: a count that is half of the given number, plus one; an array to the end.
inline constexpr ExprStep kCountSteps[] = {
    {Op::kLoadU8, 0}, {Op::kConst, 1}, {Op::kSub, 0}, {Op::kConst, 2}, {Op::kDiv, 0}};
inline constexpr Field kArrayFields[] = {
    with_valid(field("twice_and_one", Kind::kUint, 1, 0), {ValidKind::kRange, 1, 9, nullptr, 0}),
    with_count(with_type(field("pairs", Kind::kStruct, 0, 1), kPair), expr(kCountSteps)),
    repeat_to_end(field("rest", Kind::kUint, 2, -1)),
};
inline constexpr Type kArrays = type("arrays", kArrayFields);

// body: bytes with interpretations by their own first byte.
inline constexpr Field kBodyFields[] = {field("kind", Kind::kUint, 1, 0),
                                        to_end(field("payload", Kind::kBytes, 0, 1))};
inline constexpr Field kOneFields[] = {with_expect(field("tag", Kind::kUint, 1, 0), 1),
                                       field("x", Kind::kUint, 1, 1)};
inline constexpr Type kOne = type("one", kOneFields);
inline constexpr Field kTwoFields[] = {field("tag", Kind::kUint, 1, 0),
                                       field("x", Kind::kUint, 2, 1)};
inline constexpr Type kTwo = type("two", kTwoFields);
inline constexpr Field kFourFields[] = {with_expect(field("tag", Kind::kUint, 1, 0), 4),
                                        field("y", Kind::kUint, 1, 1)};
inline constexpr Type kFour = type("four", kFourFields);
inline constexpr SwitchCase kTagCases[] = {{1, &kOne}, {2, &kTwo}, {4, &kFour}};
inline constexpr ExprStep kTagSteps[] = {{Op::kLoadU8, 1}};
inline constexpr Switch kByTag = {expr(kTagSteps), kTagCases, 3, nullptr};
inline constexpr ExprStep kIsThreeSteps[] = {{Op::kLoadU8, 0}, {Op::kConst, 3}, {Op::kEq, 0}};
inline constexpr Interpretation kBodyInterpretations[] = {
    {with_choice(with_condition(to_end(field("body", Kind::kStruct, 0, 1)), expr(kIsThreeSteps)),
                 kByTag),
     1}};
inline constexpr Type kBody = [] {
  Type t = type("body", kBodyFields);
  t.interpretations = kBodyInterpretations;
  t.interpretation_count = 1;
  return t;
}();

// frame: a header in a structure of its own gives the size of the payload, and its key the type.
inline constexpr Field kHeaderFields[] = {field("size", Kind::kUint, 1, 0),
                                          field("key", Kind::kUint, 1, 1)};
inline constexpr Type kHeader = type("header", kHeaderFields);
inline constexpr ExprStep kSizeSteps[] = {{Op::kLoadU8, 0}};
inline constexpr ExprStep kKeySteps[] = {{Op::kLoadU8, 1}};
inline constexpr SwitchCase kKeyCases[] = {{1, &kPair}, {2, &kArrays}, {3, &kBody}};
inline constexpr Switch kByKey = {expr(kKeySteps), kKeyCases, 3, nullptr};
inline constexpr Field kFrameFields[] = {
    with_type(field("header", Kind::kStruct, 0, 0), kHeader),
    with_choice(with_size(field("payload", Kind::kStruct, 0, 2), expr(kSizeSteps)), kByKey),
};
inline constexpr Type kFrame = type("frame", kFrameFields);

}  // namespace rubric::reflect::toy
