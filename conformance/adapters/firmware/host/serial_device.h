// A board's serial line as a device file or a TCP port of this machine.
#pragma once

#include "conformance/adapters/firmware/host/qemu_board.h"

namespace rubric::firmware {

/// Starts the node as a sink of `island`, writes to standard output the part after `serial:` of a
/// target of `rubric test` (a device, or `tcp:HOST:PORT`) and carries bytes until standard input
/// ends. The sink's radio sends, but hears nobody. Returns the exit status.
int serve_serial_device(QemuBoard& board, std::uint16_t island, bool over_tcp);

}  // namespace rubric::firmware
