# MPI is needed by one module alone, which the command loads at run time (modules/mpi); without MPI there is no module.
# Its C interface: the one for C++ is no longer part of MPI.
enable_language(C)
find_package(MPI QUIET COMPONENTS C)
set(MOTTLE_MPI AUTO CACHE STRING "Build the module by which mpirun and srun run Mottle: ON, OFF or AUTO (where MPI is found)")
if(MOTTLE_MPI STREQUAL "AUTO")
  set(MOTTLE_MPI ${MPI_C_FOUND})  # of this configuration alone: MPI may be installed later
endif()
if(MOTTLE_MPI AND NOT MPI_C_FOUND)
  message(FATAL_ERROR "MOTTLE_MPI is ON, but MPI is not found; install libopenmpi-dev, or set it to OFF")
endif()
