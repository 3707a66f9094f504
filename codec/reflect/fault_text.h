// Words for what is wrong: codes travel, text is made where it is shown.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "codec/reflect/frame.h"
#include "codec/reflect/requirements.h"
#include "codec/runtime/result.h"

namespace rubric::reflect {

/// The name of a fault as programs read it, "out_of_range"; "none" for kNone. Stable.
std::string_view fault_name(Fault fault);
/// The other way round.
std::optional<Fault> find_fault(std::string_view name);
/// What a fault means, without its full stop.
std::string_view fault_sentence(Fault fault);

/// One sentence for a malformed frame's error, with the numbers that the rule is broken by, without
/// its full stop: "nbytes is 119, allowed are 2 to 102".
std::string error_text(const Frame& frame);
/// The same for a message that was decoded alone.
std::string error_text(const Decoded& decoded);

/// The name of a note's kind as programs read it: "does_not_fit".
std::string_view note_name(NoteKind kind);
/// One sentence for a note, without its full stop.
std::string note_text(const Note& note);

/// A field's number with its name where it has one: "1 (cc1000)".
std::string number_text(const Field& field, std::int64_t value);

}  // namespace rubric::reflect
