// Prints docs/closed_forms.md.
#include <iostream>

#include "reference/lagrangian_page.h"

int main() {
  std::cout << delassus::reference::lagrangian::closed_forms_page();
  return std::cout.good() ? 0 : 1;
}
