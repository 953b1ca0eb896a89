// Outputs of a study that its model does not have.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::expect_refused;

TEST(ReadOutputs, RefusesWhatTheModelDoesNotHave) {
  expect_refused({
      {"an output that the model does not have",
       {{"[1, 2, 3]", "[1, 2, 4]"}},
       {"outputs.frequencies", "mode 4", "1 to 3"},
       "frequencies"},
      {"mode number zero", {{"[1, 2, 3]", "[0, 1, 2]"}}, {"outputs.frequencies", ">= 1"}, "[0, 1, 2]"},
      {"a mode number that is a fraction", {{"[1, 2, 3]", "[1.5]"}}, {"outputs.frequencies", "1.5", ">= 1"}, "[1.5]"},
      {"a repeated output", {{"[1, 2, 3]", "[1, 2, 2]"}}, {"outputs.frequencies", "mode 2", "twice"}, "frequencies"},
      {"no output",
       {{"frequencies = [1, 2, 3]", "frequencies = []"}},
       {"outputs", "frequencies = [1, 2]"},
       "[outputs]"},
      {"a shape at a point that is not there",
       {{"[1, 2, 3]", R"([1, 2, 3]
shapes = { modes = [1], dofs = ["m9"] })"}},
       {"outputs.shapes.dofs", "'m9'", "m1, m2, m3"},
       "shapes"},
      {"a shape at one point twice",
       {{"[1, 2, 3]", R"([1, 2, 3]
shapes = { modes = [1], dofs = ["m1", "m1"] })"}},
       {"outputs.shapes.dofs", "'m1'", "twice"},
       "shapes"},
      {"shapes without points",
       {{"[1, 2, 3]", "[1, 2, 3]\nshapes = { modes = [1] }"}},
       {"outputs.shapes.dofs", "missing"},
       "shapes"},
      {"damping of a model without dampers",
       {{"[1, 2, 3]", "[1, 2, 3]\ndamping = [1]"}},
       {"outputs.damping", "no damper"},
       "damping"},
      {"an unknown way of tracking",
       {{"[1, 2, 3]", R"([1, 2, 3]
tracking = "macc")"}},
       {"outputs.tracking", "macc", R"("order" | "mac")", R"(did you mean "mac")"},
       "tracking"},
      {"a MAC above 1",
       {{"[1, 2, 3]", "[1, 2, 3]\nminimum_mac = 1.5"}},
       {"outputs.minimum_mac", "1.5", "<= 1"},
       "minimum_mac"},
  });
}

}  // namespace
}  // namespace mottle::study
