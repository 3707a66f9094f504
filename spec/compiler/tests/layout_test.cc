// The checker's results: sizes, offsets, ranges, inherited requirements.
#include <gtest/gtest.h>

#include "spec/compiler/load/load.h"

namespace rubricc {
namespace {

struct Loaded {
  Model model;
  Diagnostics diagnostics;

  explicit Loaded(const std::string& types) {
    load_spec_text("spec/wire/test.ksy",
                   "meta:\n  id: test\n  endian: be\n  imports: [tinyos]\ntypes:\n" + types, model,
                   diagnostics);
    check_model(model, diagnostics);
    EXPECT_EQ(diagnostics.print(), "");
  }
  const Type& type(std::string_view id) const {
    for (const auto& one : model.specs.back()->types) {
      if (one->id == id) return *one;
    }
    throw std::out_of_range("no such type");
  }
};

constexpr const char* kMessage = R"(
  message:
    -requirement: A
    seq:
      - {id: head, type: tinyos::am_header}
      - {id: count, type: u1, valid: {min: 2, max: 9}, -requirement: B}
      - {id: pad, type: u2le, if: count == 3}
      - {id: items, type: pair, repeat: expr, repeat-expr: count * 2 - 1}
      - {id: rest, size-eos: true}
  pair:
    -requirement: C
    seq:
      - {id: a, type: s1, valid: {min: -4}}
      - {id: b, type: f4le}
)";

TEST(Layout, AddsSizesUpAndStopsOffsetsWhereTheyVary) {
  const Loaded loaded(kMessage);
  const Type& message = loaded.type("message");
  EXPECT_EQ(loaded.type("pair").min_size, 5U);
  EXPECT_TRUE(loaded.type("pair").constant_size());
  EXPECT_EQ(message.min_size, 8U + 1 + 3 * 5);
  EXPECT_EQ(message.max_size, UINT32_MAX);
  const std::int64_t offsets[] = {0, 8, 9, -1, -1};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(message.fields[i]->fixed_offset, offsets[i]) << i;
  EXPECT_EQ(message.fields[2]->min_size, 0U);
  EXPECT_EQ(message.fields[2]->max_size, 2U);
  EXPECT_EQ(message.fields[3]->max_size, 17U * 5);
  EXPECT_EQ(message.fields[3]->count->range.min, 3);
  EXPECT_EQ(message.fields[3]->count->range.max, 17);
}

TEST(Layout, OffsetsReachIntoStructures) {
  const Loaded loaded(R"(
  message:
    -requirement: A
    -size: 123
    seq:
      - {id: kind, type: u1}
      - {id: head, type: tinyos::am_header}
      - {id: body, size: head.length}
)");
  const Expr& size = *loaded.type("message").fields[2]->size;
  EXPECT_EQ(size.offset_bytes, 1 + 5);
  EXPECT_EQ(size.field->id, "length");
  EXPECT_EQ(size.range.max, 114);
}

TEST(Layout, ADeclaredSizeBoundsWhatRunsToTheEnd) {
  const Loaded loaded(
      "  one:\n    -requirement: A\n    -size: 100\n    seq:\n"
      "      - {id: a, type: f4, repeat: eos}\n");
  EXPECT_EQ(loaded.type("one").min_size, 0U);
  EXPECT_EQ(loaded.type("one").max_size, 100U);
}

TEST(Layout, ContentsBecomeANumber) {
  const Loaded loaded(
      "  one:\n    -requirement: A\n    seq:\n"
      "      - {id: magic, contents: [0x55, ' ']}\n");
  const Field& magic = *loaded.type("one").fields[0];
  EXPECT_EQ(magic.kind, ValueKind::kUint);
  EXPECT_EQ(magic.width_bytes, 2);
  EXPECT_EQ(magic.valid->one_of, std::vector<std::int64_t>{0x5520});
}

TEST(Values, RangesFollowValid) {
  const Loaded loaded(kMessage);
  EXPECT_EQ(loaded.type("pair").fields[0]->range.min, -4);
  EXPECT_EQ(loaded.type("pair").fields[0]->range.max, 127);
  const Field* found = nullptr;
  for (const auto& type : loaded.model.specs.front()->types) {
    if (type->id == "am_header") found = type->fields[0].get();
  }
  ASSERT_NE(found, nullptr);
  const Field& dispatch = *found;
  EXPECT_EQ(dispatch.id, "dispatch");
  EXPECT_EQ(dispatch.range.max, 0);
}

TEST(Requirements, AreInheritedFromTheTypeAround) {
  const Loaded loaded(kMessage);
  EXPECT_EQ(loaded.type("message").fields[0]->requirement, "A");
  EXPECT_EQ(loaded.type("message").fields[1]->requirement, "B");
  EXPECT_EQ(loaded.type("pair").fields[0]->requirement, "C");
}

TEST(Switch, CasesAreSortedByKey) {
  const Loaded loaded(R"(
  message:
    -requirement: A
    seq:
      - {id: kind, type: u1}
      - id: body
        size-eos: true
        type: {switch-on: kind, cases: {9: b, 0x02: a, _: a}}
  a: {-requirement: A, seq: [{id: x, type: u2}]}
  b: {-requirement: A, seq: [{id: x, type: u1}]}
)");
  const Switch& choice = *loaded.type("message").fields[1]->choice;
  ASSERT_EQ(choice.cases.size(), 2U);
  EXPECT_EQ(choice.cases[0].key, 2);
  EXPECT_EQ(choice.cases[1].type->id, "b");
  EXPECT_EQ(choice.otherwise->type->id, "a");
  EXPECT_EQ(loaded.type("message").min_size, 2U);  // The least of all cases.
}

}  // namespace
}  // namespace rubricc
