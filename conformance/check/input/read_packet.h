// Turns one captured packet into an observation.
#pragma once

#include "codec/containers/packet.h"
#include "conformance/check/observation.h"
#include "conformance/check/storage.h"

namespace rubric::check {

/// Fills kind, frame, dsn and flags; the caller fills tap, place and direction. Returns false for
/// packets that this kit ignores (such as a beacon of another protocol).
bool observe_packet(const Packet& packet, RunStorage& storage, Observation& out);

}  // namespace rubric::check
