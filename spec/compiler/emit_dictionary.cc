#include "spec/compiler/emit.h"

namespace rubricc {

GeneratedFiles emit_dictionary(const Spec&) { return {}; }

}  // namespace rubricc
