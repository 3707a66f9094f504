#include "conformance/trace/fill.h"

#include <algorithm>
#include <string>

#include "codec/reflect/decode.h"
#include "conformance/trace/schema.h"

namespace rubric::trace {
namespace {

using reflect::Field;
using reflect::Type;
using Tree = reflect::Value;

Tree* find(Tree& tree, std::string_view name) {
  for (std::size_t i = 0; i < tree.keys.size(); ++i) {
    if (tree.keys[i] == name) return &tree.items[i];
  }
  return nullptr;
}

std::vector<const Type*> types_of(const Field& field) {
  std::vector<const Type*> types;
  const auto add = [&](const Type* type) {
    if (type && std::find(types.begin(), types.end(), type) == types.end()) types.push_back(type);
  };
  add(field.type);
  if (field.choice) {
    add(field.choice->otherwise);
    for (int i = 0; i < field.choice->count; ++i) add(field.choice->cases[i].type);
  }
  return types;
}

bool has_fields(const Type& type, const Tree& tree) {
  return std::all_of(tree.keys.begin(), tree.keys.end(), [&](const std::string& key) {
    const auto named = [&](const Field& f) { return key == f.name; };
    return std::any_of(type.fields, type.fields + type.field_count, named) ||
           std::any_of(type.interpretations, type.interpretations + type.interpretation_count,
                       [&](const reflect::Interpretation& one) { return named(one.field); });
  });
}

void fill_structure(const Field& field, Tree& tree, Choices& choices) {
  std::vector<const Type*> types = types_of(field);
  std::erase_if(types, [&](const Type* type) { return !has_fields(*type, tree); });
  if (!types.empty()) fill(*types[choices.take(types.size())], tree, choices);
}

/// Adds the member for the bytes of a field that bodies may overlay. The interpretations that share
/// its name are alternatives.
bool fill_body(const Type& type, const Field& field, Tree& tree, Choices& choices) {
  std::vector<const reflect::Interpretation*> bodies;
  for (int i = 0; i < type.interpretation_count; ++i) {
    const reflect::Interpretation& one = type.interpretations[i];
    if (&type.fields[one.overlays] != &field) continue;
    Tree* body = find(tree, one.field.name);
    if (!body || !body->is(Tree::Kind::kObject)) continue;
    std::vector<const Type*> types = types_of(one.field);
    const auto fits = [&](const Type* t) { return has_fields(*t, *body); };
    if (std::any_of(types.begin(), types.end(), fits)) bodies.push_back(&one);
  }
  if (bodies.empty()) return false;
  const reflect::Interpretation& chosen = *bodies[choices.take(bodies.size())];
  fill_structure(chosen.field, *find(tree, chosen.field.name), choices);
  return true;
}

Tree elements(const Field& field) {
  std::vector<Tree> items;
  // The encoder fills in a count that reads other fields; it does not fill in a constant one.
  if (field.repeat == reflect::Repeat::kCount && field.count.count == 1 &&
      field.count.steps[0].op == reflect::Op::kConst) {
    items.resize(static_cast<std::size_t>(field.count.steps[0].value), Tree::of_integer(0));
  }
  return Tree::of_array(std::move(items));
}

}  // namespace

std::size_t Choices::take(std::size_t count) {
  if (used_ == all_.size()) all_.push_back({0, count});
  return all_[used_++].answer;
}

bool Choices::next() {
  all_.resize(used_);
  used_ = 0;
  while (!all_.empty()) {
    if (++all_.back().answer < all_.back().count) return true;
    all_.pop_back();
  }
  return false;
}

void fill(const Type& type, Tree& tree, Choices& choices) {
  tree.kind = Tree::Kind::kObject;
  for (int i = 0; i < type.field_count; ++i) {
    const Field& f = type.fields[i];
    if (f.condition.count) continue;
    Tree* given = find(tree, f.name);
    const bool structure = f.kind == reflect::Kind::kStruct;
    if (given && structure && f.repeat == reflect::Repeat::kOnce) {
      if (given->is(Tree::Kind::kObject)) fill_structure(f, *given, choices);
    } else if (given && structure) {
      for (Tree& item : given->items) fill_structure(f, item, choices);
    } else if (given || fill_body(type, f, tree, choices)) {
      continue;
    } else if (f.repeat != reflect::Repeat::kOnce) {
      tree.set(f.name, elements(f));
    } else if (structure) {
      Tree inner = Tree::of_object();
      fill_structure(f, inner, choices);
      tree.set(f.name, std::move(inner));
    } else if (f.kind == reflect::Kind::kBytes) {
      tree.set(f.name, Tree::of_string(""));
    } else {
      const Domain domain = Domain::of(f, type);
      if (domain.derived || domain.implied >= 0) continue;
      tree.set(f.name, Tree::of_integer(std::max<std::int64_t>(domain.min, 0)));
    }
  }
}

void give_opaque(const Type& type, Tree& tree) {
  for (int i = 0; i < type.interpretation_count; ++i) {
    const reflect::Interpretation& one = type.interpretations[i];
    Tree* body = find(tree, one.field.name);
    if (!body || !body->is(Tree::Kind::kString)) continue;
    for (std::string& key : tree.keys) {
      if (key == one.field.name) key = type.fields[one.overlays].name;
    }
  }
  for (int i = 0; i < type.field_count; ++i) {
    const Field& f = type.fields[i];
    if (f.kind != reflect::Kind::kStruct || f.repeat != reflect::Repeat::kOnce) continue;
    Tree* inner = find(tree, f.name);
    if (!inner || !inner->is(Tree::Kind::kObject)) continue;
    for (const Type* inner_type : types_of(f)) give_opaque(*inner_type, *inner);
  }
}

}  // namespace rubric::trace
