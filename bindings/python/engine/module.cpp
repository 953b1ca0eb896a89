// The module mottle._engine: conversion between Python and the library, and nothing else.
#include "bindings.hpp"
#include "interpreter_end.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/study/jobs/study_objects.hpp"

PYBIND11_MODULE(_engine, module) {
  module.doc() = "Mottle's engine; use the package `mottle`.";
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
  module.def("available_threads", &mottle::available_threads, "Number of processors that this process may use.");
}
