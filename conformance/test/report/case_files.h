// Writes one case on one implementation as files that other programs read.
#pragma once

#include <string>

#include "conformance/test/suite/result.h"

namespace rubric::suite {

/// Returns its log as a trace that requires exactly this log.
std::string case_rtr(const CaseRun& one);

/// Returns its frames as a pcapng file: radio as 802.15.4 with FCS, each serial line on an
/// interface of its own, times since the case began. Leaves out PEIS, whose messages are no
/// packets. Empty if there are no frames.
std::string case_pcapng(const CaseRun& one);

/// Returns a name that is safe in every file system and needs no quoting in a URL: letters, digits
/// and ".-_~", no dot first, at most 80 characters.
std::string safe_name(std::string_view text);

}  // namespace rubric::suite
