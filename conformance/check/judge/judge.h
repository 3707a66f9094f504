// The checker: judge(), as observation.h declares it.
#pragma once

#include "conformance/check/observation.h"
