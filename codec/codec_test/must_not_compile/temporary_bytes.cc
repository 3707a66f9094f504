// The bytes of a view must live at least as long as the view.
#include "codec/generated/rubicon/rssi_beacon.h"

int main() {
  using Bytes = const uint8_t[1];
#ifdef RUBRIC_CONTROL
  Bytes bytes = {1};
  return rubric::rubicon::RssiBeaconView::parse(bytes)->anchor_id();
#else
  return rubric::rubicon::RssiBeaconView::parse(Bytes{1})->anchor_id();
#endif
}
