// Numbers of an encoding that give the size of something that follows. They may be missing: then
// they are filled in once the content that they measure is written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "codec/reflect/decode.h"
#include "codec/reflect/schema.h"

namespace rubric::reflect {

/// A number that an expression for a size or a count reads.
struct Measure {
  std::size_t offset = 0;        ///< In the output.
  const Field* field = nullptr;  ///< Null until its bytes are written.
  std::string path;
  bool missing = false;  ///< Not given, and not filled in yet.
};

/// A structure that is being written.
struct Part {
  std::size_t base = 0;              ///< Where it begins in the output.
  std::vector<std::size_t> starts;   ///< Where its fields begin, up to the present one.
  std::vector<std::int64_t> params;  ///< What the parameters of its type are.

  /// Returns where a load reads in the output.
  std::size_t place(const ExprStep& load) const {
    const std::size_t from = load.from == 0                   ? base
                             : load.from - 1U < starts.size() ? starts[load.from - 1U]
                                                              : kNowhere;
    return from + static_cast<std::size_t>(load.value);
  }
};

/// The measures met so far. Copyable, so that an attempt can be taken back.
class Measures {
 public:
  /// Notes which measures the sizes and counts of a structure of this type read: from its begin on
  /// (0), or from that of field `from - 1` on, which is the present one.
  void expect(const Type& type, const Part& in, std::uint16_t from) {
    for (int i = 0; i < type.field_count; ++i) {
      for (const Expr* expr : {&type.fields[i].size, &type.fields[i].count}) {
        const ExprStep* load = only_load(*expr);
        if (!load || load->from != from || find(in.place(*load))) continue;
        all_.push_back({in.place(*load), nullptr, {}, false});
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

  /// Returns the measure that `expr` of a structure reads; null unless it is a single one.
  Measure* of(const Expr& expr, const Part& in) {
    const ExprStep* load = only_load(expr);
    return load ? find(in.place(*load)) : nullptr;
  }

  /// Returns a measure that `expr` reads and that is missing; null if there is none.
  const Measure* missing_in(const Expr& expr, const Part& in) {
    for (int i = 0; i < expr.count; ++i) {
      if (!is_load(expr.steps[i].op)) continue;
      const Measure* measure = find(in.place(expr.steps[i]));
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
  static const ExprStep* only_load(const Expr& expr) {
    const ExprStep* found = nullptr;
    for (int i = 0; i < expr.count; ++i) {
      if (!is_load(expr.steps[i].op)) continue;
      if (found) return nullptr;
      found = &expr.steps[i];
    }
    return found;
  }

  std::vector<Measure> all_;
};

}  // namespace rubric::reflect
