// Systems of masses and springs that cannot be.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::expect_refused;

TEST(MassSpring, RefusesWhatIsNoSystem) {
  expect_refused({
      {"a negative mass", {{"m1 = 1.0", "m1 = -1.0"}}, {"model.masses.m1", "-1", "> 0"}, "m1 = -1.0"},
      {"a zero mass", {{"m1 = 1.0", "m1 = 0.0"}}, {"model.masses.m1", "found 0", "> 0"}, "m1 = 0.0"},
      {"a mass that is not a number", {{"m1 = 1.0", "m1 = nan"}}, {"model.masses.m1", "nan"}, "m1 = nan"},
      {"an infinite mass", {{"m1 = 1.0", "m1 = inf"}}, {"model.masses.m1", "inf"}, "m1 = inf"},
      {"no masses",
       {{"masses = { m1 = 1.0, m2 = 1.0, m3 = 1.0 }", "masses = {}"}},
       {"model.masses", "missing or empty"},
       "masses = {}"},
      {"a mass called ground",
       {{"m1 = 1.0,", "ground = 1.0, m1 = 1.0,"}},
       {"model.masses", "'ground'", "choose another"},
       "masses = "},
      {"a negative stiffness",
       {{R"(name = "k6", between = ["m1", "m3"], stiffness = 3.0)",
         R"(name = "k6", between = ["m1", "m3"], stiffness = -3.0)"}},
       {"model.springs.6.stiffness", "-3", ">= 0"},
       "stiffness = -3.0"},
      {"a spring to a point that is not there",
       {{R"(["m1", "m3"])", R"(["m1", "m4"])"}},
       {"model.springs.6.between", "'m4'", "did you mean", "ground, m1, m2, m3"},
       R"("m4")"},
      {"a spring with both ends on one point",
       {{R"(["m1", "m3"])", R"(["m1", "m1"])"}},
       {"model.springs.6.between", "'m1'", "acts on nothing"},
       R"(["m1", "m1"])"},
      {"a spring with three ends",
       {{R"(["m1", "m3"])", R"(["m1", "m2", "m3"])"}},
       {"model.springs.6.between", "two points"},
       R"(["m1", "m2", "m3"])"},
      {"a spring without a name",
       {{R"({ name = "k6", )", "{ "}},
       {"model.springs.6.name", "missing"},
       R"({ between = ["m1", "m3"])"},
      {"two springs of one name",
       {{R"(name = "k6")", R"(name = "k5")"}},
       {"model.springs.6.name", "'k5'", "twice"},
       R"(["m1", "m3"])"},
      {"a control character in a mass's name",
       {{"m1 = 1.0", R"("m\n1" = 1.0)"}},
       {"model.masses", "control characters"}},
  });
}

TEST(ReadStudy, RefusesUnknownModelsAndUnits) {
  expect_refused({
      {"an unknown kind of model",
       {{R"("mass-spring")", R"("nastrann")"}},
       {"model.kind", "nastrann", "mass-spring"},
       "nastrann"},
      {"an unknown system of units",
       {{R"(units = "SI")", R"(units = "imperial")"}},
       {"units", "imperial", "in-lbf-s", "mm-t-s"},
       "imperial"},
      {"no model",
       {{R"([model]
kind = "mass-spring")",
         R"([modell]
kind = "mass-spring")"}},
       {"modell", "did you mean 'model'"},
       "[modell]"},
  });
}

}  // namespace
}  // namespace mottle::study
