// The public header: what an operator is (operators/operator.h), and the table of all of them (operators/operators.h).
#pragma once

#include "algorithms/operators/operator.h"
#include "algorithms/operators/operators.h"
