#include "spec/compiler/emit.h"

namespace rubricc {

GeneratedFiles emit_messages(const Spec&) { return {}; }

}  // namespace rubricc
