// One case on one implementation as files that other programs read.
#pragma once

#include <string>

#include "conformance/suite/result.h"

namespace rubric::suite {

/// Its log as a trace that asks for just this.
std::string case_rtr(const CaseRun& one);

/// Its frames as a pcapng file: radio as 802.15.4 with FCS, each serial line on an interface of its
/// own, times since the case began. Frames of PEIS are no packets and stay out. Empty without any.
std::string case_pcapng(const CaseRun& one);

/// A name that is safe in every file system and needs no quoting in a URL: letters, digits and
/// ".-_~", no dot first, at most 80 characters.
std::string safe_name(std::string_view text);

}  // namespace rubric::suite
