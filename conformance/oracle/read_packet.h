// One captured packet as an observation.
#pragma once

#include "codec/containers/packet.h"
#include "conformance/oracle/observation.h"
#include "conformance/oracle/storage.h"

namespace rubric::oracle {

/// Fills kind, frame, dsn and flags; tap, place and direction are the caller's. False: nothing
/// that this kit looks at (such as a beacon of another protocol).
bool observe_packet(const Packet& packet, RunStorage& storage, Observation& out);

}  // namespace rubric::oracle
