// The offline oracle: judge(), as observation.h declares it.
#pragma once

#include "conformance/oracle/observation.h"
