// Turns one captured packet into an observation.
#pragma once

#include "codec/containers/packet.h"
#include "conformance/oracle/observation.h"
#include "conformance/oracle/storage.h"

namespace rubric::oracle {

/// Fills kind, frame, dsn and flags; the caller fills tap, place and direction. Returns false for
/// packets that this kit ignores (such as a beacon of another protocol).
bool observe_packet(const Packet& packet, RunStorage& storage, Observation& out);

}  // namespace rubric::oracle
