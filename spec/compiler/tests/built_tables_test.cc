// The tables in memory are those that were generated: of every spec that is generated.
#include "spec/compiler/emit/tables/built_tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "codec/frame_generator/routes.h"
#include "codec/reflect/registry.h"
#include "spec/compiler/load/load.h"
#include "spec/compiler/wire_specs.h"

namespace rubricc {
namespace {

namespace reflect = rubric::reflect;

/// Writes tables as text, every member of them.
class Dump {
 public:
  static std::string of(const reflect::Protocol& protocol, const reflect::RouteTable* routes) {
    Dump dump;
    dump.put(protocol.id, protocol.title);
    for (int i = 0; i < protocol.type_count; ++i) dump.type(*protocol.types[i]);
    for (int i = 0; i < protocol.enum_count; ++i) dump.enumeration(protocol.enums[i]);
    for (int i = 0; i < protocol.mask_count; ++i) dump.mask(protocol.masks[i]);
    for (int i = 0; i < protocol.carrier_count; ++i) {
      dump.put("carrier", protocol.carriers[i].name, protocol.carriers[i].type->id);
    }
    for (int i = 0; routes && i < routes->count; ++i) dump.route(routes->routes[i]);
    return dump.text_;
  }

 private:
  template <class... Values>
  void put(const Values&... values) {
    ((text_ += fmt::format("{}|", values)), ...);
    text_ += '\n';
  }

  void type(const reflect::Type& type) {
    put("type", type.id, type.name, type.field_count, type.interpretation_count, type.min_size,
        type.max_size, type.am_type, static_cast<int>(type.requirement), type.doc, type.doc_ref);
    for (int i = 0; i < type.field_count; ++i) field(type.fields[i]);
    for (int i = 0; i < type.interpretation_count; ++i) {
      put("overlays", type.interpretations[i].overlays);
      field(type.interpretations[i].field);
    }
  }

  void field(const reflect::Field& field) {
    put(field.name, field.json_key, field.json_key_size, static_cast<int>(field.kind),
        field.width_bytes, field.little_endian, static_cast<int>(field.repeat),
        static_cast<int>(field.extent), field.fixed_offset, field.expect,
        static_cast<int>(field.requirement), field.doc, field.type ? field.type->id : "");
    const reflect::Valid& valid = field.valid;
    put("valid", static_cast<int>(valid.kind), valid.min, valid.max);
    for (int i = 0; i < valid.one_of_count; ++i) put(valid.one_of[i]);
    enumeration(field.enumeration);
    mask(field.mask);
    if (field.choice) {
      put("switch", field.choice->otherwise ? field.choice->otherwise->id : "");
      expr(field.choice->key);
      for (int i = 0; i < field.choice->count; ++i) {
        const reflect::SwitchCase& one = field.choice->cases[i];
        put(one.key, one.type ? one.type->id : "");
      }
    }
    for (const auto& one : {field.size, field.count, field.condition}) expr(one);
    if (field.unit) put("unit", field.unit->symbol, field.unit->scale, field.unit->offset);
  }

  void expr(const reflect::Expr& expr) {
    put("expr", expr.count);
    for (int i = 0; i < expr.count; ++i) {
      put(static_cast<int>(expr.steps[i].op), expr.steps[i].value);
    }
  }

  void enumeration(const reflect::EnumTable* table) {
    if (!table) return;
    put("enum", table->name);
    for (int i = 0; i < table->count; ++i) put(table->entries[i].value, table->entries[i].name);
  }

  void mask(const reflect::MaskTable* table) {
    if (!table) return;
    put("mask", table->name);
    for (int i = 0; i < table->width_bits; ++i) put(table->bit_names[i] ? table->bit_names[i] : "");
  }

  void route(const reflect::Route& route) {
    put("route", route.carrier, route.type->id, route.offset, route.room);
    for (int i = 0; i < route.choice_count; ++i) {
      const reflect::RouteChoice& one = route.choices[i];
      put("choice", one.offset, one.width_bytes, one.little_endian, one.value);
    }
    for (int i = 0; i < route.length_count; ++i) {
      const reflect::RouteLength& one = route.lengths[i];
      put("length", one.offset, one.width_bytes, one.little_endian, one.from);
    }
  }

  std::string text_;
};

TEST(BuiltTables, AreThoseThatWereGenerated) {
  Model model;
  Diagnostics diagnostics;
  load_requirements("spec/requirements.yaml", model, diagnostics);
  load_specs(wire_specs(), model, diagnostics);
  check_model(model, diagnostics, CheckFor::kRunTime);
  ASSERT_TRUE(diagnostics.empty()) << diagnostics.print();
  const BuiltTables tables(model);
  ASSERT_EQ(reflect::specs().size(), model.specs.size());
  for (const reflect::Protocol* generated : reflect::specs()) {
    const BuiltSpec built = tables.of(generated->id);
    ASSERT_TRUE(built.protocol) << generated->id;
    const auto* routes = rubric::generate::routes_of(*generated);
    EXPECT_EQ(Dump::of(*built.protocol, routes ? built.routes : nullptr),
              Dump::of(*generated, routes))
        << generated->id;
  }
  EXPECT_EQ(tables.of("nothing").protocol, nullptr);
}

TEST(BuiltTables, FieldsLieSideBySide) {
  Model model;
  Diagnostics diagnostics;
  load_requirements("spec/requirements.yaml", model, diagnostics);
  load_specs({"spec/wire/rubicon.ksy"}, model, diagnostics);
  check_model(model, diagnostics, CheckFor::kRunTime);
  const BuiltTables tables(model);
  const reflect::Protocol& protocol = *tables.of("rubicon").protocol;
  std::uintptr_t first = UINTPTR_MAX, last = 0;
  for (int i = 0; i < protocol.type_count; ++i) {
    const auto at = reinterpret_cast<std::uintptr_t>(protocol.types[i]->fields);
    if (at == 0) continue;
    first = std::min(first, at);
    last = std::max(last, at);
  }
  EXPECT_LT(last - first, std::uintptr_t{1} << 18);
}

TEST(BuiltTables, NeedNoRequirement) {
  const std::string text =
      "meta: {id: plain, endian: be}\ntypes:\n  one: {seq: [{id: a, type: u1}]}\n";
  for (const CheckFor what : {CheckFor::kCode, CheckFor::kRunTime}) {
    Model model;
    Diagnostics diagnostics;
    load_spec_text("plain.ksy", text, model, diagnostics);
    check_model(model, diagnostics, what);
    EXPECT_EQ(diagnostics.empty(), what == CheckFor::kRunTime) << diagnostics.print();
  }
}

}  // namespace
}  // namespace rubricc
