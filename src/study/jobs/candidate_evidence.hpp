// Candidates of a diagnosis by the evidence of the models with them.
#pragma once

#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/diagnose.hpp"

namespace mottle::study {

/// Samples the posterior of the parameters alone, and with each of the best `study.diagnose.evidence` candidates that
/// have a fit in the model, and compares their evidences. By the study's method where it gives an evidence, else by
/// `hierarchical`. A model whose posterior cannot be sampled is left out with its reason, the parameters alone too: a
/// diagnosis that may have cost a night is not lost to it.
///
/// @param candidates  all of the diagnosis
/// @return            nothing where the study asks for none
/// @throws Stopped     on request
DiagnosisEvidence evidence_of_candidates(const Study& study, const std::vector<StudyParameter>& candidates,
                                         const Diagnosis& diagnosis, const RunSettings& settings,
                                         const RunContext& context);

}  // namespace mottle::study
