// Moved: algorithms/closest.h.
#pragma once

#include "algorithms/closest.h"
