// Words for faults: codes travel, text is made where it is shown.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "codec/reflect/frame.h"
#include "codec/reflect/requirements.h"
#include "codec/runtime/result.h"

namespace rubric::reflect {

/// Returns the name of a fault as programs read it, "out_of_range"; "none" for kNone. Stable.
std::string_view fault_name(Fault fault);
/// Returns the fault of a name.
std::optional<Fault> find_fault(std::string_view name);
/// Returns a fault's meaning, without its full stop.
std::string_view fault_sentence(Fault fault);

/// Returns one sentence for a malformed frame's error, with the numbers that break the rule,
/// without its full stop: "nbytes is 119, allowed are 2 to 102".
std::string error_text(const Frame& frame);
/// Returns the same for a message that was decoded alone.
std::string error_text(const Decoded& decoded);

/// Returns the name of a note's kind as programs read it: "does_not_fit".
std::string_view note_name(NoteKind kind);
/// Returns one sentence for a note, without its full stop.
std::string note_text(const Note& note);

/// Returns an integer of a field in decimal digits.
std::string integer_text(const Field& field, std::int64_t value);
/// Returns a field's number with its name if it has one: "1 (cc1000)".
std::string number_text(const Field& field, std::int64_t value);

}  // namespace rubric::reflect
