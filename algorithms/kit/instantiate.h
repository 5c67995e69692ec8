// The scalars a source is compiled for. Each source of a recursion is compiled twice: for the library delassus (double, float),
// and for delassus_exact (the scalars of the tests), which defines DELASSUS_EXACT. What is no template stands in
// `#ifndef DELASSUS_EXACT`.
#pragma once

#ifdef DELASSUS_EXACT
#include "algorithms/kit/test_scalars.h"
#define DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(X) X(::delassus::Quad) X(::delassus::Counted)
#define DELASSUS_FOR_EACH_ORDERED_SCALAR(X) DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(X) X(::delassus::Rational)
#define DELASSUS_FOR_EACH_SCALAR(X) DELASSUS_FOR_EACH_ORDERED_SCALAR(X) X(::delassus::PrimeField)
#else
#define DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(X) X(double) X(float)
#define DELASSUS_FOR_EACH_ORDERED_SCALAR(X) X(double) X(float)
#define DELASSUS_FOR_EACH_SCALAR(X) X(double) X(float)
#endif
