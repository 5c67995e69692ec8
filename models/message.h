// Moved: algorithms/message.h.
#pragma once

#include "algorithms/message.h"
