// Orders types so that contained ones come first; no type contains itself.
#include <functional>
#include <map>

#include "spec/compiler/check/check.h"

namespace rubricc {
namespace {

constexpr int kTypeNestingMax = 100;

enum class Mark { kNew, kOpen, kDone };

class Order {
 public:
  explicit Order(Check& check) : check_(check) {}

  void visit(Type& type, int depth) {
    marks_[&type] = Mark::kOpen;
    for (const auto* list : {&type.fields, &type.instances}) {
      for (const auto& field : *list) visit_field(*field, depth);
    }
    marks_[&type] = Mark::kDone;
    check_.order.push_back(&type);
  }

  Mark mark(const Type& type) { return marks_[&type]; }

 private:
  void visit_field(const Field& field, int depth) {
    if (field.type != nullptr) {
      visit_used(*field.type, field, place_of(field.places, "type", field.place), depth);
    }
    if (!field.choice) return;
    for (const SwitchCase& one : field.choice->cases) {
      if (one.type != nullptr) visit_used(*one.type, field, one.place, depth);
    }
    const auto& otherwise = field.choice->otherwise;
    if (otherwise && otherwise->type != nullptr) {
      visit_used(*otherwise->type, field, otherwise->place, depth);
    }
  }

  void visit_used(const Type& used, const Field& field, const Place& place, int depth) {
    if (marks_[&used] == Mark::kOpen) {
      check_.error(place, fmt::format("type {} contains itself", quote(used.id)),
                   "types must not form a circle");
      check_.open.insert(&field);
    } else if (depth > kTypeNestingMax) {
      check_.error(place, "types nest too deep", fmt::format("at most {} levels", kTypeNestingMax));
      check_.open.insert(&field);
    } else if (marks_[&used] == Mark::kNew) {
      visit(const_cast<Type&>(used), depth + 1);  // The model is ours to complete.
    }
  }

  Check& check_;
  std::map<const Type*, Mark> marks_;
};

}  // namespace

void check_order(Check& check) {
  Order order(check);
  for (const auto& spec : check.model.specs) {
    for (const auto& type : spec->types) {
      if (order.mark(*type) == Mark::kNew) order.visit(*type, 0);
    }
  }
  for (const auto& spec : check.model.specs) {
    spec->dependency_order.clear();
    for (const Type* type : check.order) {
      if (type->spec == spec.get()) spec->dependency_order.push_back(type);
    }
  }
}

}  // namespace rubricc
