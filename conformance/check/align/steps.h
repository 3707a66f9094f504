// Steps of a recorder's clock: stamps that contradict the order of their file.
//
// A recorder writes frames as they come, so the order of a file is stronger evidence than its
// stamps: those jump where somebody sets the clock, and a single one may be wrong. Each tap keeps
// the order of its file; a stamp far before the one before it is a step.
//
// Decides: where the clock of a file stepped (Run::steps), and times that go on from there. A file
// whose taps alternate is one recorder, whose taps step together; in a file that has one tap after
// another each tap is looked at alone.
//
// Evidence, for a frame whose stamp is more than kJitterUs before that of its tap, or kAcrossUs
// before that of another tap of the recorder (kJitterUs, too, in a file of which no more than
// kTurnedMax stamps go back at all):
// - If the stamps go on before it as if the one before had never been, that one alone may be wrong;
//   if those after it do, this one may be. A stamp is wrong alone if its neighbours are closer to
//   each other than a hundredth of what it is off, since a step that makes up for two gaps so
//   nearly would be chance; it then lies between them.
// - Else the clock stepped back, and how much time passed is unknown. Where either could be true,
//   it stepped twice.
// - Forth: an acknowledgement of the link that comes kLateAckUs after its frame (kLongUs in a file
//   of fewer than kManyFrames), with nothing of the air between the two; a silence of all taps
//   without which an effect, such as a forward, came in time after its cause, and which is long, or
//   before which no sender's DSNs have a gap (more than kInterruptedMax, or one for each
//   kFramesEach frames of a short file, are slow nodes: then "in time" is what leaves so many); or,
//   in a file of kManyFrames, a silence that is longer than kSilenceUs and by far than any other
//   (kSilences). Silences that would put a repeated ack_join in time must be among as many longest
//   ones of the file: nothing forces a mote to repeat one, so that one that is late between
//   ordinary silences is the mote's doing.
//
// Cannot know: a step forth that looks like an ordinary silence, and one back that is shorter than
// the silence in which it happened. Where a clock stepped forth elsewhere, response times are
// longer by what may hide so (Run::slack_us).
//
// Why a doubt here blames nobody: judge_each_gap() judges the run as if the frames after each step
// had come at once, and as late as they can have come: after a step forth as the stamps say, since
// less time passed than that, after one back much later. A failure remains if both have it.
#pragma once

#include <cstdint>

#include "conformance/check/align/align.h"
#include "conformance/check/observation.h"

namespace rubric::check {

/// Finds the steps of the clocks of `run`, whose stamps are those of the files and whose `seen` is
/// in the order of files. Changes the times after a step so that they go on; Run::steps and
/// Run::facts say where. Nodes that take no longer than `response_us` are not late.
void mend_steps(Run& run, std::int64_t response_us = AlignOptions{}.response_us);

/// Sets the times of Run::steps from those that their frames have by now.
void place_steps(Run& run);

}  // namespace rubric::check
