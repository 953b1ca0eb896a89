// Keys that no study has, and values of another type than their key's.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::expect_refused;

TEST(ReadStudy, NamesTheNearestKnownKeyToAnUnknownOne) {
  expect_refused({
      {"unknown key at the top",
       {{R"(units = "SI")", R"(unit = "SI")"}},
       {"unit: is not known here", "did you mean 'units'", "Known:"},
       "unit = "},
      {"unknown table at the top", {{"[outputs]", "[output]"}}, {"output", "did you mean 'outputs'"}, "[output]"},
      {"unknown key in the model",
       {{"springs = [", "sprigns = ["}},
       {"model.sprigns", "did you mean 'springs'"},
       "sprigns"},
      {"unknown key in a spring",
       {{R"("m1"], stiffness = 1.0)", R"("m1"], stifness = 1.0)"}},
       {"model.springs.1.stifness", "did you mean 'stiffness'"},
       "stifness"},
      {"unknown key in a parameter",
       {{"bounds = [0.5, 3.0]", "bound = [0.5, 3.0]"}},
       {"parameter.1.bound", "did you mean 'bounds'"},
       "bound = "},
      {"unknown key in a distribution",
       {{R"({ kind = "normal", mean = 2.0, std = 0.3 }
bounds = [0.5, 3.0])",
         R"({ kind = "normal", mean = 2.0, std = 0.3, sdt = 1.0 })"}},
       {"parameter.1.distribution.sdt", "did you mean 'std'"},
       "sdt"},
      {"unknown key in the outputs",
       {{"frequencies = [1, 2, 3]", "frequencies = [1]\nfrequences = [1, 2, 3]"}},
       {"outputs.frequences", "did you mean 'frequencies'"},
       "frequences"},
      {"unknown key in the shapes",
       {{"frequencies = [1, 2, 3]", R"(shapes = { modes = [1], dofs = ["m1"], x = 1 })"}},
       {"outputs.shapes.x", "Known: dofs, modes"},
       "shapes = "},
      {"unknown key in the test",
       {{R"(file = "tests.csv")", R"(file = "tests.csv"
repeatibility = { f1 = 0.1 })"}},
       {"test.repeatibility", "did you mean 'repeatability'"},
       "repeatibility"},
      {"unknown key in the update",
       {{"iterations = 30", "iteration = 30"}},
       {"update.iteration", "did you mean 'iterations'"},
       "iteration = "},
      {"unknown option of the method",
       {{"weighting =", "weigthing ="}},
       {"update.mares", "'weigthing'", "did you mean 'weighting'"},
       "weigthing"},
      {"unknown option of a method that is not chosen",
       {{"[update.mares]", "[update.deterministic]\nspecimens = 2\n[update.mares]"}},
       {"update.deterministic", "'specimens'", "did you mean 'specimen'"},
       "specimens = 2"},
      {"unknown key in the correlation",
       {{"[outputs]", "[correlation]\nmatrx = [[1, 0], [0, 1]]\n[outputs]"}},
       {"correlation.matrx", "did you mean 'matrix'"},
       "matrx"},
      {"unknown key in the truth",
       {{"[outputs]", "[truth]\nspecimen = 10\n\n[outputs]"}},
       {"truth.specimen", "did you mean 'specimens'"},
       "specimen = 10"},
  });
}

TEST(ReadStudy, SaysWhatWasFoundInPlaceOfTheTypeThatIsAllowed) {
  expect_refused({
      {"a text for a number",
       {{"samples = 200", R"(samples = "many")"}},
       {"update.samples", "many", "whole number", R"("auto")"},
       R"(samples = "many")"},
      {"a fraction for a whole number",
       {{"iterations = 30", "iterations = 2.5"}},
       {"update.iterations", "2.5", "whole number"},
       "iterations = 2.5"},
      {"a number for a text",
       {{R"(title = "A study for tests")", "title = 3"}},
       {"title", "found 3", "text"},
       "title = 3"},
      {"a number for a table",
       {{R"([test]
file = "tests.csv")",
         ""},
        {"[model]", "test = 3\n[model]"}},
       {"test", "found 3", "table"},
       "test = 3"},
      {"a text for a list of modes",
       {{"frequencies = [1, 2, 3]", R"(frequencies = "all")"}},
       {"outputs.frequencies", "all", "[1, 2, 3]"},
       R"(frequencies = "all")"},
      {"a table for a list of tables",
       {{"[outputs]", "[outputs]"}, {"springs = [", "dampers = { c1 = 1.0 }\nsprings = ["}},
       {"model.dampers", "list of tables"},
       "dampers"},
      {"a list for an option",
       {{R"(weighting = "mahalanobis")", "model_error = [1]"}},
       {"update.mares.model_error", "found [1]"},
       "model_error = [1]"},
      {"true for a stiffness",
       {{R"(name = "k1", between = ["ground", "m1"], stiffness = 1.0)",
         R"(name = "k1", between = ["ground", "m1"], stiffness = true)"}},
       {"model.springs.1.stiffness", "found true", "number >= 0"},
       "stiffness = true"},
  });
}

}  // namespace
}  // namespace mottle::study
