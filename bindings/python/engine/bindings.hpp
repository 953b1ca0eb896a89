// The parts of the module _engine; each adds its names.
#pragma once

#include <pybind11/pybind11.h>

namespace mottle::python {

void add_errors(pybind11::module_& module);
void add_studies(pybind11::module_& module);
void add_outcomes(pybind11::module_& module);
void add_decks(pybind11::module_& module);
void add_models(pybind11::module_& module);
void add_statistics(pybind11::module_& module);
void add_population(pybind11::module_& module);
void add_reduced_models(pybind11::module_& module);
void add_deck_files(pybind11::module_& module);
void add_universal_files(pybind11::module_& module);

}  // namespace mottle::python
