// What a program that uses the library needs: studies and their jobs, models and methods, all as names of mottle.
#pragma once

#include "mottle/core/error.hpp"            // what is thrown, and what it means
#include "mottle/core/parallel.hpp"         // how many threads there are
#include "mottle/core/run_context.hpp"      // seed, threads, progress, stop
#include "mottle/model/function_model.hpp"  // a model of one's own
#include "mottle/model/parameters/parameter_space.hpp"
#include "mottle/report/report.hpp"      // report.html of a folder of results
#include "mottle/study/input/study.hpp"  // a study file as plain data
#include "mottle/study/jobs/check.hpp"
#include "mottle/study/jobs/diagnose.hpp"
#include "mottle/study/jobs/forward.hpp"
#include "mottle/study/jobs/modes.hpp"
#include "mottle/study/jobs/update.hpp"
#include "mottle/updating/methods/updater.hpp"  // every method over any model
#include "mottle/updating/verdict/verdict.hpp"

namespace mottle {
using namespace report;  // which sees all layers
}
