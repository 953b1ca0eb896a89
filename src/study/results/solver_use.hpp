// How the samples of a run were solved, for result.json and the log.
#pragma once

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// Sets "reduction" (null where no reduced model was used) and adds a sentence to "notes".
void add_solver_use(const SolverUse& use, Json& result);

/// The same sentence with times, and the runs of a solver.
void log_solver_use(const SolverUse& use, const RunContext& context);

}  // namespace mottle::study
