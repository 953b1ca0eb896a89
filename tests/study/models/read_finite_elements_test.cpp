// [model] of the kinds "mesh", "matrices", "nastran" and "calculix", where it is wrong.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::expect_unread;
using test::WrongStudy;

const std::string k_rest = R"([[parameter]]
name = "p"
target = "some:target"
distribution = { kind = "normal", mean = 1.0, std = 0.1 }
[outputs]
frequencies = [1]
)";
const std::string k_mesh = R"([model]
kind = "mesh"
file = "plate.msh"
materials = [ { name = "aluminium", young = 70e9, poisson = 0.3, density = 2700 } ]
sections = [ { group = "plate", material = "aluminium", thickness = 0.002 } ]
supports = [ { group = "edges", directions = ["X", "Y", "Z"] } ]
masses = [ { group = "tip", mass = 0.1 } ]
springs = [ { name = "s", groups = ["mount"], direction = "Z", stiffness = 100.0 } ]
)" + k_rest;
const std::string k_matrices = R"([model]
kind = "matrices"
stiffness = "K.mtx"
mass = "M.mtx"
terms = [ { name = "far", stiffness = "K2.mtx", nominal = 2.0 } ]
)" + k_rest;

WrongStudy wrong(const std::string& found, const std::string& put, std::vector<std::string> says) {
  return {.what = put,
          .changes = {{found, put}},
          .says = std::move(says),
          .at = put.empty() ? "terms" : test::lines_of(put).back()};
}

TEST(MeshModel, RefusesMaterialsAndSectionsThatAreNone) {
  const std::string section = "thickness = 0.002";
  expect_unread(
      k_mesh,
      {
          wrong("file = \"plate.msh\"", "file = 3", {"model.file", "found 3", "text"}),
          wrong("file = \"plate.msh\"", "file = \"plate.msh\"\nlength_factor = 0", {"model.length_factor", "> 0"}),
          wrong("file = \"plate.msh\"", "file = \"plate.msh\"\nmass = \"lump\"", {"model.mass", "lump", "\"lumped\""}),
          wrong("materials = [ { name = \"aluminium\", young = 70e9, poisson = 0.3, density = 2700 } ]",
                "materials = []", {"model.materials", "is missing or empty"}),
          wrong("young = 70e9", "young = 0", {"model.materials.1.young", "found 0", "> 0"}),
          wrong("poisson = 0.3", "poisson = 0.5", {"model.materials.1.poisson: found 0.5, allowed is less than 0.5"}),
          wrong("poisson = 0.3", "poisson = -1.0", {"model.materials.1.poisson", "> -1"}),
          wrong("density = 2700", "density = -1", {"model.materials.1.density", "-1", ">= 0"}),
          wrong("density = 2700 }", "density = 2700 }, { name = \"aluminium\", young = 1, poisson = 0, density = 0 }",
                {"model.materials.2.name", "'aluminium' is given twice"}),
          wrong("sections = [ { group = \"plate\", material = \"aluminium\", thickness = 0.002 } ]", "sections = []",
                {"model.sections", "is missing or empty"}),
          wrong(section, "thickness = 0", {"model.sections.1.thickness", "found 0", "> 0"}),
          wrong(section, "thicknes = 0.002", {"model.sections.1.thicknes", "not known here"}),
          wrong(section, "shape = \"TUBES\", dimensions = [0.1]", {"model.sections.1.shape", "'TUBES'", "TUBE"}),
          wrong(section, "shape = \"TUBE\", dimensions = [0.1]",
                {"model.sections.1.dimensions", "1 numbers, TUBE has 2"}),
          wrong(section, "area = 1, orientation = [0, 1]", {"model.sections.1.orientation", "three numbers"}),
      });
}

TEST(MeshModel, RefusesSupportsMassesAndSpringsThatAreNone) {
  expect_unread(
      k_mesh,
      {
          wrong("[\"X\", \"Y\", \"Z\"]", "[\"U\"]",
                {"model.supports.1.directions", "'U' is no direction", "RX, RY, RZ"}),
          wrong("mass = 0.1", "mass = -0.1", {"model.masses.1.mass", "-0.1", ">= 0"}),
          wrong("mass = 0.1 }", "mass = 0.1 }, { group = \"tip\", mass = 1 }",
                {"model.masses.2.group", "'tip' is given twice"}),
          wrong("groups = [\"mount\"]", "groups = [\"a\", \"b\", \"c\"]", {"model.springs.1.groups", "one group"}),
          wrong("direction = \"Z\"", "direction = \"W\"", {"model.springs.1.direction", "'W' is no direction"}),
          wrong("stiffness = 100.0", "stiffness = -1", {"model.springs.1.stiffness", "-1", ">= 0"}),
          wrong("springs = [", "spring = [", {"model.spring", "did you mean 'springs'"}),
      });
}

TEST(MatrixModel, RefusesTermsThatAreNone) {
  expect_unread(k_matrices,
                {
                    wrong("stiffness = \"K2.mtx\"", "stiffness = 3", {"model.terms.1.stiffness", "found 3", "text"}),
                    wrong(", stiffness = \"K2.mtx\"", "", {"model.terms.1.stiffness", "give stiffness, mass or both"}),
                    wrong("nominal = 2.0", "nominal = -2.0", {"model.terms.1.nominal", "-2", "> 0"}),
                    wrong("nominal = 2.0", "exponent = 0", {"model.terms.1.exponent", "other than 0"}),
                    wrong("nominal = 2.0", "exponent = 10", {"model.terms.1.exponent", "10", "<= 9"}),
                    wrong("name = \"far\", ", "", {"model.terms.1.name", "missing"}),
                    wrong("mass = \"M.mtx\"", "mass = 1", {"model.mass", "found 1", "text"}),
                    wrong("terms = [", "term = [", {"model.term", "did you mean 'terms'"}),
                });
}

TEST(DeckModels, RefuseKeysThatAreNone) {
  expect_unread(
      "[model]\nkind = \"nastran\"\nfile = \"deck.bdf\"\n" + k_rest,
      {
          {"no deck", {{"file = \"deck.bdf\"", "deck = \"deck.bdf\""}}, {"model.file", "missing"}, "[model]"},
          wrong("file = \"deck.bdf\"", "file = \"deck.bdf\"\nsubcase = 0", {"model.subcase", "found 0", ">= 1"}),
          wrong("file = \"deck.bdf\"", "file = \"deck.bdf\"\nignore_cards = 3", {"model.ignore_cards", "found 3"}),
          wrong("file = \"deck.bdf\"", "file = \"deck.bdf\"\nprogram = \"ccx\"", {"model.program", "not known here"}),
      });
  expect_unread(
      "[model]\nkind = \"calculix\"\nfile = \"deck.inp\"\n" + k_rest,
      {
          wrong("file = \"deck.inp\"", "file = \"deck.inp\"\nparallel = 0", {"model.parallel", "found 0", ">= 1"}),
          wrong("file = \"deck.inp\"", "file = \"deck.inp\"\ntimeout = \"soon\"", {"model.timeout", "a time > 0"}),
          wrong("file = \"deck.inp\"", "file = \"deck.inp\"\nprogram = 1", {"model.program", "found 1", "text"}),
          wrong("file = \"deck.inp\"", "file = \"deck.inp\"\nsubcase = 1", {"model.subcase", "not known here"}),
      });
}

}  // namespace
}  // namespace mottle::study
