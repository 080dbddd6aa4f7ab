// SPDX-License-Identifier: MIT
#include <middle.hpp>

int whole_main();

int main() { return middle_fractions()[0] == 0.5 ? whole_main() : 1; }
