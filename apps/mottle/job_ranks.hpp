// The processes of a job that mpirun or srun has started: what each of them does, and how they end together.
#pragma once

#include <string>

#include "mottle/core/ranks.hpp"
#include "mottle/layers.hpp"

namespace mottle::app {

/// Whether this process is one of several that a launcher started, and not the first: it says nothing, and what is not
/// shared out is not its business.
bool is_silent_rank();

/// Joins the other processes where a launcher has started several. Throws SystemFailure where that cannot be, or where
/// their processors would compute other numbers.
///
/// @param verb  the command's: all ranks need the same (InvalidInput)
/// @return  null: this process is alone. Else lives until the process ends
Ranks* join_job(const std::string& verb);

/// Joined ranks end the job together. What is to be said, and the exit code; rank 0 hears of the others' errors.
RankEnd end_job(const RankEnd& own);

}  // namespace mottle::app
