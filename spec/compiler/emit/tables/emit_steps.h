// Expressions as postfix steps, and the names of codec/reflect/schema.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spec/compiler/model.h"

namespace rubricc {

struct Step {
  std::string op;  // "Op::kLoadBe16"
  std::int64_t value = 0;
};
std::vector<Step> postfix(const Expr& expr);

std::string kind_name(ValueKind kind);
std::string repeat_name(RepeatKind repeat);
std::string extent_name(ExtentKind extent);

}  // namespace rubricc
