// The same where the bytes have no name at all.
#include "codec/generated/rubicon/rssi_beacon.h"

int main() {
#ifdef RUBRIC_CONTROL
  const uint8_t bytes[] = {1, 2, 3};
  return rubric::rubicon::RssiBeaconView::parse(bytes)->anchor_id();
#else
  return rubric::rubicon::RssiBeaconView::parse({1, 2, 3})->anchor_id();
#endif
}
