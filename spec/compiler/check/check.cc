// The passes over the model, in their order.
#include "spec/compiler/check/check.h"

#include "spec/compiler/load/load.h"

namespace rubricc {

void check_model(Model& model, Diagnostics& diagnostics) {
  Check check{model, diagnostics, {}};
  check_names(check);
  check_order(check);
  check_layout(check);
  check_types(check);
  if (diagnostics.empty()) check_cpp(check);  // It lays out what the passes before it completed.
}

}  // namespace rubricc
