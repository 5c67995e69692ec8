// Which build of the library the loader picked.
#include <cstdio>

#include "algorithms/delassus.h"

int main() { std::printf("%s\n", delassus::kernels().data()); }
