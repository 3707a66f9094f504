#include "codec/reflect/encode.h"

#include <gtest/gtest.h>

#include <string>

#include "codec/containers/tests/testing.h"
#include "spec/compiler/emit/tables/built_tables.h"
#include "spec/compiler/load/load.h"

namespace rubric::reflect {
namespace {

using rubric::testing::to_hex;

// Every kind of field that tables can express, in few types.
constexpr const char* kToy = R"(
meta: {id: toy, endian: be}
enums:
  colour: {1: red, 2: green, 7: blue}
types:
  flags:
    -mask: 8
    seq: [{id: odd, type: b1}, {id: bit6, type: b1, -unnamed: true},
          {id: bit5, type: b1, -unnamed: true}, {id: bit4, type: b1, -unnamed: true},
          {id: bit3, type: b1, -unnamed: true}, {id: bit2, type: b1, -unnamed: true},
          {id: down, type: b1}, {id: up, type: b1}]
  scalars:
    -requirement: WIRE-CONFIG
    seq:
      - {id: colour, type: u1, enum: colour}
      - {id: flags, type: flags}
      - {id: little, type: u2le, -unit: {symbol: mV, scale: 0.5}}
      - {id: signed, type: s2}
      - {id: real, type: f4le}
      - {id: four_or_six, type: u1, valid: {any-of: [4, 6]}}
      - {id: seven, type: u1, valid: {min: 7, max: 7}}
      - {id: eight, type: u1, -expect: 8}
      - {id: if_red, type: u4, if: 'colour == colour::red'}
  pair:
    -requirement: WIRE-CONFIG
    seq: [{id: a, type: u1}, {id: b, type: u1}]
  arrays:
    -requirement: WIRE-CONFIG
    seq:
      - {id: twice_and_one, type: u1, valid: {min: 1, max: 9}}
      - {id: pairs, type: pair, repeat: expr, repeat-expr: (twice_and_one - 1) / 2}
      - {id: rest, type: u2, repeat: eos}
  body:
    -requirement: WIRE-CONFIG
    seq: [{id: kind, type: u1}, {id: payload, size-eos: true}]
    instances:
      tag: {pos: 1, type: u1}
      body: {if: kind == 3, pos: 1, size-eos: true,
             type: {switch-on: tag, cases: {1: one, 2: two, 4: four}}}
  one:
    -requirement: WIRE-CONFIG
    seq: [{id: tag, type: u1, -expect: 1}, {id: x, type: u1}]
  two:
    -requirement: WIRE-CONFIG
    seq: [{id: tag, type: u1}, {id: x, type: u2}]
  four:
    -requirement: WIRE-CONFIG
    seq: [{id: tag, type: u1, -expect: 4}, {id: y, type: u1}]
  header:
    -requirement: WIRE-CONFIG
    seq: [{id: size, type: u1}, {id: key, type: u1}]
  frame:
    -requirement: WIRE-CONFIG
    seq:
      - {id: header, type: header}
      - {id: payload, size: header.size,
         type: {switch-on: header.key, cases: {1: pair, 2: arrays, 3: body}}}
)";

const Type& toy(const char* name) {
  static const auto* const kTables = [] {
    rubricc::Model model;
    rubricc::Diagnostics diagnostics;
    rubricc::load_requirements("spec/requirements.yaml", model, diagnostics);
    rubricc::load_spec_text("toy.ksy", kToy, model, diagnostics);
    rubricc::check_model(model, diagnostics, rubricc::CheckFor::kRunTime);
    EXPECT_EQ(diagnostics.print(), "");
    return new rubricc::BuiltTables(model);
  }();
  return *find_type(*kTables->of("toy").protocol, name);
}

using Pairs = std::vector<std::pair<std::string, Value>>;

Value integer(std::int64_t number) { return Value::of_integer(number); }
Value string(std::string_view text) { return Value::of_string(text); }
Value real(std::string_view text) { return Value::of_real(text); }
Value array(std::vector<Value> items) { return Value::of_array(std::move(items)); }
Value object(Pairs pairs) {
  Value value = Value::of_object();
  for (auto& [key, item] : pairs) value.set(key, std::move(item));
  return value;
}
Value pair(int a, int b) { return object({{"a", integer(a)}, {"b", integer(b)}}); }

// Returns `fields` with some members replaced, added, or (null) removed.
Value changed(const Value& fields, const Pairs& changes) {
  Value result = Value::of_object();
  for (std::size_t i = 0; i < fields.keys.size(); ++i) {
    const Value* change = nullptr;
    for (const auto& [key, value] : changes) {
      if (key == fields.keys[i]) change = &value;
    }
    if (!change) {
      result.set(fields.keys[i], fields.items[i]);
    } else if (!change->is(Value::Kind::kNull)) {
      result.set(fields.keys[i], *change);
    }
  }
  for (const auto& [key, value] : changes) {
    if (!fields.find(key)) result.set(key, value);
  }
  return result;
}

std::string encoded(const Type& type, const Value& fields, std::string_view stale = "",
                    Tail tail = Tail::kFault) {
  std::vector<std::uint8_t> stale_bytes;
  EXPECT_TRUE(parse_hex(stale, stale_bytes));
  std::vector<std::uint8_t> out;
  encode(type, fields, Bytes(stale_bytes.data(), stale_bytes.size()), tail, out);
  return to_hex(Bytes(out.data(), out.size()));
}

// Returns the bytes or "path: problem".
std::string outcome(const Type& type, const Value& fields, std::string_view stale = "",
                    Tail tail = Tail::kFault) {
  try {
    return encoded(type, fields, stale, tail);
  } catch (const EncodeError& error) {
    EXPECT_NE(error.requirement(), ReqId::kNone);
    return error.what();
  }
}

Value scalars() {
  return object({{"colour", integer(2)},
                 {"flags", integer(0x83)},
                 {"little", integer(0x1234)},
                 {"signed", integer(-2)},
                 {"real", real("1.5")},
                 {"four_or_six", integer(6)},
                 {"seven", integer(7)},
                 {"eight", integer(9)}});
}

Value header(int key) { return object({{"key", integer(key)}}); }
Value sized(int size, int key) { return object({{"size", integer(size)}, {"key", integer(key)}}); }

TEST(Encode, Scalars) {
  EXPECT_EQ(encoded(toy("scalars"), scalars()),
            "0283"
            "3412"
            "fffe"
            "0000c03f"
            "060709");
}

struct Row {
  const char* name;
  Pairs changes;
  std::string expected;
};
Row bad(const char* name, const std::string& field, Value value, const char* problem) {
  return {name, {{field, std::move(value)}}, field + ": " + problem};
}
void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }

const Row kGood[] = {
    {"EnumByName", {{"colour", string("green")}}, "02833412fffe0000c03f060709"},
    {"EnumByNameBeside",
     {{"colour", {}}, {"colour_name", string("blue")}},
     "07833412fffe0000c03f060709"},
    {"EnumBoth", {{"colour_name", string("green")}}, "02833412fffe0000c03f060709"},
    {"EnumUnknownNull",
     {{"colour", integer(9)}, {"colour_name", {}}},
     "09833412fffe0000c03f060709"},
    {"ConditionalField",
     {{"colour", integer(1)}, {"if_red", integer(0x01020304)}},
     "01833412fffe0000c03f06070901020304"},
    {"MaskByBits",
     {{"flags", array({string("odd"), string("bit5"), string("bit0")})}},
     "02a13412fffe0000c03f060709"},
    {"MaskByBitsBeside",
     {{"flags", {}}, {"flags_bits", array({string("down")})}},
     "02023412fffe0000c03f060709"},
    {"MaskEmpty", {{"flags", array({})}}, "02003412fffe0000c03f060709"},
    {"MaskBoth",
     {{"flags_bits", array({string("up"), string("down"), string("odd")})}},
     "02833412fffe0000c03f060709"},
    {"Nan", {{"real", string("NaN")}}, "02833412fffe0000c07f060709"},
    {"Infinity", {{"real", string("Infinity")}}, "02833412fffe0000807f060709"},
    {"MinusInfinity", {{"real", string("-Infinity")}}, "02833412fffe000080ff060709"},
    {"FloatWhole", {{"real", integer(2)}}, "02833412fffe00000040060709"},
    {"FloatMinusZero", {{"real", real("-0.0")}}, "02833412fffe00000080060709"},
    {"FloatSubnormal", {{"real", real("1e-45")}}, "02833412fffe01000000060709"},
    {"OnlyValueImplied", {{"seven", {}}}, "02833412fffe0000c03f060709"},
    {"ExpectedValueImplied", {{"eight", {}}}, "02833412fffe0000c03f060708"},
    {"ConvertedBesideIsIgnored", {{"little_mV", real("0.5")}}, "02833412fffe0000c03f060709"},
    {"SmallestSigned", {{"signed", integer(-32768)}}, "0283341280000000c03f060709"},
};

class EncodeGood : public ::testing::TestWithParam<Row> {};
TEST_P(EncodeGood, Bytes) {
  EXPECT_EQ(outcome(toy("scalars"), changed(scalars(), GetParam().changes)), GetParam().expected);
}
INSTANTIATE_TEST_SUITE_P(Rows, EncodeGood, ::testing::ValuesIn(kGood),
                         [](const auto& row) { return row.param.name; });

const Row kBad[] = {
    bad("Missing", "little", {}, "is missing: expected a number from 0 to 65535"),
    bad("TooLarge", "little", integer(65536), "expected a number from 0 to 65535, given 65536"),
    bad("Negative", "little", integer(-1), "expected a number from 0 to 65535, given -1"),
    bad("BelowSigned", "signed", integer(-32769),
        "expected a number from -32768 to 32767, given -32769"),
    bad("NoNumber", "little", string("x"), "expected a number from 0 to 65535, given \"x\""),
    bad("RealForInteger", "little", real("1.5"), "expected a number from 0 to 65535, given 1.5"),
    bad("ObjectForNumber", "little", pair(1, 2),
        "expected a number from 0 to 65535, given an object"),
    bad("UnknownName", "colour", string("pink"),
        "expected a name of colour (red, green, blue), given \"pink\""),
    {"UnknownNameBeside",
     {{"colour_name", string("pink")}},
     "colour: colour_name: expected a name of colour (red, green, blue), given \"pink\""},
    {"NamesDisagree",
     {{"colour_name", string("red")}},
     "colour: is given as 2, but colour_name says 1; expected one of them alone, or both the "
     "same"},
    {"BitsDisagree",
     {{"flags_bits", array({string("up")})}},
     "flags: is given as 131, but flags_bits says 1; expected one of them alone, or both the "
     "same"},
    bad("UnknownBit", "flags", array({string("bit8")}),
        "expected bits of flags (up, down, bit2, bit3, bit4, bit5, bit6, odd), given "
        "\"bit8\""),
    {"BitsNoArray",
     {{"flags_bits", integer(3)}},
     "flags: flags_bits: expected an array of bit names, given 3"},
    bad("FloatTooLarge", "real", real("1e39"),
        "expected a number that binary32 can hold, given 1e39"),
    bad("FloatNoNumber", "real", string("nan"),
        "expected a number, \"NaN\", \"Infinity\" or \"-Infinity\", given \"nan\""),
    bad("NotOneOf", "four_or_six", integer(5), "expected 4 or 6, given 5"),
    bad("OutOfRange", "seven", integer(8), "expected a number from 7 to 7, given 8"),
    bad("UnknownField", "litle", integer(1),
        "is not a field of scalars here, which has colour, flags, little, signed, real, "
        "four_or_six, seven, eight, if_red"),
    bad("ConditionFalse", "if_red", integer(1),
        "is not a field of scalars here, which has colour, flags, little, signed, real, "
        "four_or_six, seven, eight, if_red"),
};

class EncodeBad : public ::testing::TestWithParam<Row> {};
TEST_P(EncodeBad, Error) {
  EXPECT_EQ(outcome(toy("scalars"), changed(scalars(), GetParam().changes)), GetParam().expected);
}
INSTANTIATE_TEST_SUITE_P(Rows, EncodeBad, ::testing::ValuesIn(kBad),
                         [](const auto& row) { return row.param.name; });

TEST(Encode, FieldGivenTwice) {
  Value fields = pair(1, 2);
  fields.set("a", integer(1));
  EXPECT_EQ(outcome(toy("pair"), fields), "a: is given twice");
}

TEST(Encode, NoObject) {
  EXPECT_EQ(outcome(toy("pair"), integer(1)),
            ": expected an object with the fields of pair, given 1");
}

// Counts and sizes.

TEST(Encode, CountFilledIn) {
  const Value fields =
      object({{"pairs", array({pair(1, 2), pair(3, 4)})}, {"rest", array({integer(5)})}});
  EXPECT_EQ(outcome(toy("arrays"), fields),
            "05"
            "0102"
            "0304"
            "0005");
}

TEST(Encode, CountChecked) {
  Value fields =
      object({{"twice_and_one", integer(5)}, {"pairs", array({pair(1, 2)})}, {"rest", array({})}});
  EXPECT_EQ(outcome(toy("arrays"), fields),
            "twice_and_one: expected 1, given 2: pairs has 1 element");
  fields = changed(fields, {{"twice_and_one", integer(4)}});
  EXPECT_EQ(outcome(toy("arrays"), fields),
            "04"
            "0102");  // Decoding divides, so this is accepted.
}

TEST(Encode, CountBeyondItsBound) {
  const Value fields =
      object({{"pairs", array(std::vector<Value>(5, pair(1, 2)))}, {"rest", array({})}});
  EXPECT_EQ(outcome(toy("arrays"), fields),
            "twice_and_one: expected a number from 1 to 9, given 11, as pairs has 5 elements");
}

TEST(Encode, SizeBeyondItsWidth) {
  const Value fields =
      object({{"header", header(9)}, {"payload", string(std::string(2 * 256, '0'))}});
  EXPECT_EQ(outcome(toy("frame"), fields),
            "header.size: expected a number from 0 to 255, but payload has 256 bytes");
}

TEST(Encode, ArrayProblems) {
  Value fields = object({{"pairs", array({pair(1, 2), pair(3, 400)})}, {"rest", array({})}});
  EXPECT_EQ(outcome(toy("arrays"), fields),
            "pairs[1].b: expected a number from 0 to 255, given 400");
  fields = object({{"pairs", integer(1)}, {"rest", array({})}});
  EXPECT_EQ(outcome(toy("arrays"), fields), "pairs: expected an array, given 1");
  fields = object({{"pairs", array({})}});
  EXPECT_EQ(outcome(toy("arrays"), fields), "rest: is missing: expected an array");
}

TEST(Encode, SizeInAnotherStructure) {
  EXPECT_EQ(outcome(toy("frame"), object({{"header", header(1)}, {"payload", pair(8, 9)}})),
            "0201"
            "0809");
  EXPECT_EQ(outcome(toy("frame"), object({{"header", sized(2, 1)}, {"payload", pair(8, 9)}})),
            "0201"
            "0809");
}

TEST(Encode, SizeTooSmall) {
  EXPECT_EQ(outcome(toy("frame"), object({{"header", sized(1, 1)}, {"payload", pair(8, 9)}})),
            "header.size: expected 2, given 1: payload has 2 bytes");
}

TEST(Encode, SizeTooLarge) {
  const Value fields = object({{"header", sized(5, 1)}, {"payload", pair(8, 9)}});
  EXPECT_EQ(outcome(toy("frame"), fields), "header.size: expected 2, given 5: payload has 2 bytes");
  EXPECT_EQ(outcome(toy("frame"), fields, "aabb"),
            "header.size: expected 2, given 5: payload has 2 bytes and 2 stale ones are left");
}

TEST(Encode, StaleBytesFillUp) {
  const Value given = object({{"header", sized(5, 1)}, {"payload", pair(8, 9)}});
  EXPECT_EQ(outcome(toy("frame"), given, "aabbcc"),
            "0501"
            "0809"
            "aabbcc");
  EXPECT_EQ(outcome(toy("frame"), given, "aabbccdd"),
            "stale: expected 3 bytes, given 4: the sizes in the fields leave no room for more");
  EXPECT_EQ(outcome(toy("frame"), given, "aabbccdd", Tail::kStale),
            "0501"
            "0809"
            "aabbccdd");
  const Value open = object({{"header", header(1)}, {"payload", pair(8, 9)}});
  EXPECT_EQ(outcome(toy("frame"), open, "aabb"),
            "0401"
            "0809"
            "aabb");
  EXPECT_EQ(outcome(toy("frame"), open, "aabb", Tail::kStale),
            "0201"
            "0809"
            "aabb");
}

TEST(Encode, MissingKey) {
  const Value fields =
      object({{"header", object({{"size", integer(2)}})}, {"payload", pair(8, 9)}});
  EXPECT_EQ(outcome(toy("frame"), fields),
            "header.key: is missing: expected a number from 0 to 255");
}

TEST(Encode, UnknownKeyIsOpaque) {
  const Value header9 = header(9);
  EXPECT_EQ(outcome(toy("frame"), object({{"header", header9}, {"payload", string("0A 0b")}})),
            "0209"
            "0a0b");
  EXPECT_EQ(outcome(toy("frame"), object({{"header", header9}, {"payload", string("0a0")}})),
            "payload: expected hex digits, given \"0a0\"");
  EXPECT_EQ(outcome(toy("frame"), object({{"header", header9}, {"payload", pair(1, 2)}})),
            "payload: expected hex digits, given an object");
}

TEST(Encode, ArrayToTheEndFillsItsPart) {
  const auto frame = [](int size) {
    return object(
        {{"header", sized(size, 2)},
         {"payload", object({{"pairs", array({})}, {"rest", array({integer(1), integer(2)})}})}});
  };
  EXPECT_EQ(outcome(toy("frame"), frame(5)),
            "0502"
            "01"
            "00010002");
  EXPECT_EQ(outcome(toy("frame"), frame(7), "0000"),
            "payload.rest: its 2 elements end at byte 7, expected byte 9");
}

// Interpretations.

Value body(int kind, const char* key, Value value) {
  return object({{"kind", integer(kind)}, {key, std::move(value)}});
}

TEST(Encode, InterpretationByItsOwnFirstByte) {
  const auto tagged = [](int tag, int x) {
    return object({{"tag", integer(tag)}, {"x", integer(x)}});
  };
  EXPECT_EQ(outcome(toy("body"), body(3, "body", tagged(1, 5))),
            "03"
            "01"
            "05");
  EXPECT_EQ(outcome(toy("body"), body(3, "body", tagged(2, 5))),
            "03"
            "02"
            "0005");
  EXPECT_EQ(outcome(toy("body"), body(3, "body", tagged(1, 5)), "ff", Tail::kStale), "030105ff");
  EXPECT_EQ(outcome(toy("body"), body(3, "body", tagged(2, 70000))),
            "body.x: expected a number from 0 to 65535, given 70000");
  EXPECT_EQ(outcome(toy("body"), body(3, "body", tagged(3, 1))),
            "body: no message of body has these fields here");
  EXPECT_EQ(outcome(toy("body"), body(4, "body", tagged(1, 5))),
            "body: no message of body has these fields here");
}

TEST(Encode, MistakeIsThatOfTheMessageWhoseFieldsAreGiven) {
  EXPECT_EQ(outcome(toy("body"), body(3, "body", object({{"y", integer(5)}}))), "030405");
  EXPECT_EQ(outcome(toy("body"), body(3, "body", object({{"y", integer(256)}}))),
            "body.y: expected a number from 0 to 255, given 256");
}

TEST(Encode, OpaqueInPlaceOfInterpretation) {
  EXPECT_EQ(outcome(toy("body"), body(3, "payload", string("0105"))), "030105");
  EXPECT_EQ(outcome(toy("body"), object({{"kind", integer(3)}})), "03");
  Value both = body(3, "payload", string("0105"));
  both.set("body", object({}));
  EXPECT_EQ(outcome(toy("body"), both),
            "body: is not a field of body here, which has kind, payload");
}

TEST(ParseHex, Rows) {
  std::vector<std::uint8_t> out;
  EXPECT_TRUE(parse_hex("00 fF 1a2B", out));
  EXPECT_EQ(to_hex(Bytes(out.data(), out.size())), "00ff1a2b");
  for (const char* bad : {"0", "0 0", "gg", "0x12", "12\n"}) {
    EXPECT_FALSE(parse_hex(bad, out)) << bad;
  }
}

}  // namespace
}  // namespace rubric::reflect
