// A board's serial line as a device file of this machine.
#pragma once

#include "conformance/adapters/firmware/host/qemu_board.h"

namespace rubric::firmware {

/// Starts the node as a sink of `island`, writes the device's name to standard output and carries
/// bytes until standard input ends. The sink's radio sends, but
/// hears nobody. Returns the exit status.
int serve_serial_device(QemuBoard& board, std::uint16_t island);

}  // namespace rubric::firmware
