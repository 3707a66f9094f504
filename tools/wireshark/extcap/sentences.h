// Answers to Wireshark, in the sentences that extcap(4) describes.
#pragma once

#include <string>
#include <string_view>

namespace rubric::extcap {

/// Answers --extcap-interfaces.
std::string interfaces();
/// Answers --extcap-dlts.
std::string link_types();
/// Answers --extcap-config. With `reload`, an option's name, only its present choices.
std::string config(std::string_view reload = {});

}  // namespace rubric::extcap
