// The subcommands of rubric. Each is the file of its name, which adds itself to the program.
#pragma once

#include "tools/cli/command.h"

namespace rubric::tools {

void add_chart(cli::Command& program);
void add_check(cli::Command& program);
/// Adds the subcommand; the others must exist when it runs.
void add_completion(cli::Command& program);
void add_convert(cli::Command& program);
void add_coverage(cli::Command& program);
void add_decode(cli::Command& program);
void add_diff(cli::Command& program);
void add_encode(cli::Command& program);
void add_explain(cli::Command& program);
void add_explore(cli::Command& program);
void add_forward(cli::Command& program);
void add_generate(cli::Command& program);
void add_install_wireshark(cli::Command& program);
void add_messages(cli::Command& program);
void add_monitor(cli::Command& program);
void add_new_adapter(cli::Command& program);
void add_new_protocol(cli::Command& program);
void add_repro(cli::Command& program);
void add_send(cli::Command& program);
void add_shrink(cli::Command& program);
void add_run(cli::Command& program);
void add_simulate(cli::Command& program);
void add_stats(cli::Command& program);
void add_test(cli::Command& program);

}  // namespace rubric::tools
