#include "study/results/solver_use.hpp"

namespace mottle::study {
namespace {

std::string reduction_text(const SolverUse& use) {
  return fmt::format(
      "A reduced model of {} vectors solved {} of {} samples, each frequency, in ascending order, within {:.1e} of the "
      "full model's.",
      use.basis, use.reduced, use.reduced + use.exact, use.frequency_error);
}

}  // namespace

void add_solver_use(const SolverUse& use, Json& result) {
  result["reduction"] = nullptr;
  if (use.reduced == 0) return;
  result["reduction"] = {{"samples", use.reduced},
                         {"refined_samples", use.refined},
                         {"exact_samples", use.exact},
                         {"basis_vectors", use.basis},
                         {"frequency_error_bound", use.frequency_error}};
  result["notes"].push_back(reduction_text(use));
}

void log_solver_use(const SolverUse& use, const RunContext& context) {
  if (use.runs > 0) {
    context.note(
        fmt::format("{} solver runs were needed; {} of them had been done before, and their results were taken "
                    "from runs.store",
                    use.runs, use.repeated));
  }
  if (use.reduced == 0) return;
  context.note(fmt::format("{} It took {:.2f} s of processor time; full solutions would have taken about {:.3g} s.",
                           reduction_text(use), use.reduced_seconds,
                           static_cast<double>(use.reduced) * use.exact_seconds));
}

}  // namespace mottle::study
