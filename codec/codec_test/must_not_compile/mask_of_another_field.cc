// An actuator is not a transducer.
#include "codec/generated/rubicon/mote_desc.h"

using namespace rubric::rubicon;

bool has_led(MoteDescView desc) {
#ifdef RUBRIC_CONTROL
  return desc.actuators().has(ActuatorMask::kLed);
#else
  return desc.transducers().has(ActuatorMask::kLed);
#endif
}
