#include "spec/compiler/emit.h"

namespace rubricc {

GeneratedFiles emit_doc(const Model&) { return {}; }

}  // namespace rubricc
