// `--protocol DIR`, which the commands have that test any protocol.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/command.h"

namespace rubric::tools {

/// Adds the option.
void add_protocol_option(cli::Command& command, std::string& folder);

/// Sets the protocol of a folder in RUBICON's place: its app.yaml, requirements.yaml and wire spec.
/// If no traces are given these are its cases. Does nothing if `folder` is empty. Mistakes in the
/// files are printed, and end the subcommand. Throws UsageError if one of `profiles`, which the
/// user chose, is none of the protocol; empty ones are not looked at.
void use_protocol(const std::string& folder, const std::vector<std::string>& profiles,
                  std::vector<std::string>& traces);

}  // namespace rubric::tools
