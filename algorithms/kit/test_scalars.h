// The scalars of the library delassus_exact.
#pragma once

#include "algorithms/kit/counted.h"
#include "algorithms/kit/exact.h"
#include "algorithms/kit/quad.h"
#include "algorithms/kit/stochastic.h"
