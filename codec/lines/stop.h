// Lets Ctrl-C end, cleanly, what has no end of its own.
#pragma once

namespace rubric::lines {

/// Makes the first SIGINT, SIGTERM or SIGHUP only ask to stop; another one, half a second later or
/// more, ends the process as it would have. A signal that was ignored at start, as under nohup,
/// stays ignored.
void stop_on_signals();
/// Returns whether one has come.
bool stop_requested();
/// Does the same as a signal.
void request_stop();

}  // namespace rubric::lines
