// The module mottle._engine: conversion between Python and the library, and nothing else.
#include "bindings.hpp"
#include "interpreter_end.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/linalg/blas_kernels.hpp"
#include "mottle/study/jobs/study_objects.hpp"

PYBIND11_MODULE(_engine, module) {
  module.doc() = "Mottle's engine; use the package `mottle`.";
  mottle::linalg::choose_blas_kernels();  // before anything is computed
  mottle::python::stop_jobs_at_interpreter_end();
  mottle::python::add_errors(module);
  mottle::python::add_studies(module);
  mottle::python::add_outcomes(module);
  mottle::python::add_decks(module);
  mottle::python::add_models(module);
  mottle::python::add_statistics(module);
  mottle::python::add_population(module);
  mottle::python::add_reduced_models(module);
  mottle::python::add_deck_files(module);
  mottle::python::add_universal_files(module);
  module.def("version", &mottle::study::version, "Version of the library, as of the command.");
  module.def("blas_kernels", &mottle::linalg::blas_kernels,
             "OpenBLAS's name of the processors that its kernels are for; empty where another BLAS is in use.");
  module.def("are_blas_kernels_outdated", &mottle::linalg::are_blas_kernels_outdated,
             "Whether BLAS computes with the kernels for its oldest processors although this one could do more.");
  module.def("available_threads", &mottle::available_threads, "Number of processors that this process may use.");
}
