// Numbers of an encoding that give the size of something that follows. They may be missing: then
// they are filled in once the content that they measure is written.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::reflect {

/// A number that an expression for a size or a count reads.
struct Measure {
  std::size_t offset = 0;        ///< In the output.
  const Field* field = nullptr;  ///< Null until its bytes are written.
  std::string path;
  bool missing = false;  ///< Not given, and not filled in yet.
};

/// The measures met so far. Copyable, so that an attempt can be taken back.
class Measures {
 public:
  /// Notes that a structure of this type begins at `base`: its sizes and counts read measures.
  void expect(const Type& type, std::size_t base) {
    for (int i = 0; i < type.field_count; ++i) {
      for (const Expr* expr : {&type.fields[i].size, &type.fields[i].count}) {
        const ExprStep* load = only_load(*expr);
        if (!load || find(place(*load, base))) continue;
        all_.push_back({place(*load, base), nullptr, {}, false});
      }
    }
  }

  /// Returns the measure at this offset; null if the number there measures nothing.
  Measure* find(std::size_t offset) {
    for (Measure& measure : all_) {
      if (measure.offset == offset) return &measure;
    }
    return nullptr;
  }

  /// Returns the measure that `expr` of the structure at `base` reads; null unless it is a single
  /// one.
  Measure* of(const Expr& expr, std::size_t base) {
    const ExprStep* load = only_load(expr);
    return load ? find(place(*load, base)) : nullptr;
  }

  /// Returns a measure that `expr` reads and that is missing; null if there is none.
  const Measure* missing_in(const Expr& expr, std::size_t base) {
    for (int i = 0; i < expr.count; ++i) {
      if (!is_load(expr.steps[i])) continue;
      const Measure* measure = find(place(expr.steps[i], base));
      if (measure && measure->missing) return measure;
    }
    return nullptr;
  }

  /// Returns a measure that nothing filled in; null if there is none.
  const Measure* first_missing() const {
    for (const Measure& measure : all_) {
      if (measure.missing) return &measure;
    }
    return nullptr;
  }

 private:
  static bool is_load(const ExprStep& step) {
    return step.op >= Op::kLoadU8 && step.op <= Op::kLoadLe32;
  }
  static std::size_t place(const ExprStep& load, std::size_t base) {
    return base + static_cast<std::size_t>(load.value);
  }
  static const ExprStep* only_load(const Expr& expr) {
    const ExprStep* found = nullptr;
    for (int i = 0; i < expr.count; ++i) {
      if (!is_load(expr.steps[i])) continue;
      if (found) return nullptr;
      found = &expr.steps[i];
    }
    return found;
  }

  std::vector<Measure> all_;
};

}  // namespace rubric::reflect
