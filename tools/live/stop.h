// Ctrl-C ends what has no end of its own, cleanly.
#pragma once

namespace rubric::live {

/// From now on the first SIGINT, SIGTERM or SIGHUP only asks to stop; another one, half a second
/// later or more, ends the process as it would have. A signal that was ignored at start, as nohup
/// does it, stays ignored.
void stop_on_signals();
/// Whether one has come.
bool stop_requested();
/// As if one had come.
void request_stop();

}  // namespace rubric::live
