// Makes BLAS use the registers that this processor has.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::app {

/// Debian's OpenBLAS takes a processor younger than itself for its oldest one and runs four times slower than it could.
/// Where that has happened, names the right kernels in OPENBLAS_CORETYPE and starts the program again, since the
/// library reads it only while it is loaded. Does nothing where the variable is set or another BLAS is in use.
void choose_blas_kernels(char** arguments);

}  // namespace mottle::app
