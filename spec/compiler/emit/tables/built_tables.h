// Reflection tables in memory, from the same model as the generated ones: of specs that are read
// when a program runs.
#pragma once

#include <map>
#include <memory>
#include <memory_resource>
#include <string>
#include <vector>

#include "codec/reflect/schema.h"
#include "spec/compiler/model.h"

namespace rubricc {

/// Returns an expression as the tables have it.
std::vector<rubric::reflect::ExprStep> postfix(const Expr& expr);

/// The tables of one spec.
struct BuiltSpec {
  const rubric::reflect::Protocol* protocol = nullptr;
  const rubric::reflect::RouteTable* routes = nullptr;
};

/// The tables of all specs of a checked model; they live as long as this.
class BuiltTables {
 public:
  explicit BuiltTables(const Model& model);
  BuiltTables(const BuiltTables&) = delete;
  BuiltTables& operator=(const BuiltTables&) = delete;

  /// Returns no tables where the model has no spec of this id.
  BuiltSpec of(const std::string& id) const;

 private:
  class Builder;

  static constexpr std::size_t kFieldBytes = 1U << 19;  // Of far more fields than specs have.

  std::vector<std::shared_ptr<const void>> kept_;
  std::pmr::monotonic_buffer_resource fields_{kFieldBytes};
  std::map<std::string, BuiltSpec> specs_;
};

}  // namespace rubricc
