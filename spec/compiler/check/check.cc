// The passes over the model, in their order.
#include "spec/compiler/check/check.h"

#include "spec/compiler/load/load.h"

namespace rubricc {

void check_model(Model& model, Diagnostics& diagnostics, CheckFor what) {
  const bool for_code = what == CheckFor::kCode;
  Check check{model, diagnostics, !for_code, {}};
  check_names(check);
  check_order(check);
  check_layout(check);
  check_types(check);
  if (!for_code) diagnostics.pardon_code();
  if (for_code && diagnostics.empty())
    check_cpp(check);  // It lays out what the passes before it completed.
}

}  // namespace rubricc
