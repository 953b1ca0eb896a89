// Which kernels BLAS computes with, and how it comes to those of this processor.
#pragma once

#include <string>

#include "mottle/layers.hpp"

namespace mottle::linalg {

/// OpenBLAS's name of the processors that its kernels are for ("SkylakeX"); empty where another BLAS is in use.
std::string blas_kernels();

/// Debian's OpenBLAS takes a processor younger than itself for its oldest kind (Prescott), and runs four times slower
/// than it could. Where that has happened, changes to the kernels for the registers that this processor has. The bits
/// of products are then those of a process that was started with these kernels named in OPENBLAS_CORETYPE.
///
/// No other thread may compute with BLAS meanwhile: to be called at the start of a program, or by a library that is
/// loaded into one. Nothing is changed unless all other threads come to sleep within 0.2 s (under Python all that would
/// compute do, since the caller holds the interpreter's lock). Nor is it where OPENBLAS_CORETYPE is set, or another
/// BLAS is in use. The environment stays as it was: processes that are started later have a BLAS, and perhaps a
/// processor, of their own.
void choose_blas_kernels();

/// Whether BLAS computes with the kernels for its oldest processors although this one could do more, and nobody has
/// asked for that in OPENBLAS_CORETYPE.
bool are_blas_kernels_outdated();

}  // namespace mottle::linalg
