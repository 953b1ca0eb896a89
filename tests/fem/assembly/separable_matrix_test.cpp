// The promise behind every fast sample: K(x), M(x) and C(x) from terms are those of a new assembly.
#include "mottle/fem/assembly/separable_matrix.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "fem/models.hpp"

namespace mottle::fem {
namespace {

using test::dense;
using test::field_of;
using test::moved;
using test::scaled_difference;

using Field = std::tuple<const char*, int, const char*>;

/// Every kind of element, a cylindrical displacement system, a rigid body and an interpolation.
FiniteElementModel mixed_model() {
  test::ModelMaker maker;
  FiniteElementModel& model = maker.model;
  model.settings = {.automatic_constraints = AutomaticConstraints::none, .coupled_mass = true, .mass_factor = 0.5};
  model.coordinate_systems.push_back({.id = 1, .kind = CoordinateSystem::Kind::cylindrical, .origin = {-1, -1, 0}});
  const double corners[8][3] = {{0, 0, 0}, {1, 0, 0},   {1.1, 1, 0}, {0, 1, 0},
                                {0, 0, 1}, {1, 0, 1.2}, {1, 1, 1},   {0, 1, 1}};
  for (int k = 0; k < 8; ++k) maker.node(k + 1, {corners[k][0], corners[k][1], corners[k][2]}, k == 6 ? 0 : -1);
  const int tip = maker.node(9, {2.5, 0.3, 0.4}, 0), end = maker.node(10, {2.5, 1.5, 0.4}),
            hub = maker.node(11, {3, 1, 1});
  const int solid = maker.material(1, 7e10, 0.3, 2700.0);
  const int metal = maker.material(2, 2e11, 0.28, 7800.0);
  model.elements<SolidElement>().push_back({.id = 1, .nodes = {0, 1, 2, 3, 4, 5, 6, 7}, .material = solid});
  const int skin = maker.shell_property(3, metal, 0.02);
  model.elements<ShellElement>().push_back(
      {.id = 2, .nodes = {4, 5, 6, 7}, .property = skin, .offset = 0.05, .bending_over_shear = 1e-3});
  const int stiff = maker.beam_property(4, metal, 1e-3, 2e-6, 1e-6, 1.5e-6);
  const int soft = maker.beam_property(5, metal, 2e-3, 3e-6, 2e-6, 2e-6);
  model.beam_properties[1].shear_1 = model.beam_properties[1].shear_2 = 0.8;
  maker.beam(3, 1, tip, stiff);
  maker.beam(4, tip, end, soft, {1, 0, 0.2});
  maker.rod(5, 2, end, solid, maker.field("PROD", 6, "A", 3e-4));
  maker.spring(6, tip, 2, end, 2, 1e6);
  model.elements<ScalarElement>().push_back(
      {ScalarElement::Kind::damper, 7, {tip, -1}, {0, 0}, maker.field("PDAMP", 7, "B", 12.0)});
  maker.mass(8, end, 1, 3.0);
  BushElement bush{.id = 9, .nodes = {end, hub}, .location = {2.7, 1.2, 0.5}};
  for (int c = 0; c < 6; ++c) {
    bush.stiffness[static_cast<std::size_t>(c)] = maker.field("PBUSH", 9, "K" + std::to_string(c + 1), 1e5 * (c + 1));
  }
  bush.damping[0] = maker.field("PBUSH", 9, "B1", 30.0);
  model.elements<BushElement>().push_back(bush);
  PointMassElement& mass = maker.point_mass(10, hub, 5.0);
  mass.offset = {0.1, 0.2, -0.1};
  mass.inertia[0] = maker.field("CONM2", 10, "I11", 0.4);
  mass.inertia[1] = maker.field("CONM2", 10, "I21", 0.05);
  const int arm = maker.node(12, {4, 1, 2}), mean = maker.node(13, {2, 2, 2});
  maker.point_mass(11, arm, 1.0);
  maker.point_mass(12, mean, 2.0);
  model.rigid_bodies.push_back({.id = 13, .independent = hub, .components = k_all_components, .dependents = {arm}});
  model.interpolations.push_back({.id = 14,
                                  .reference = mean,
                                  .reference_components = k_all_components,
                                  .sources = {{4, 0x7, 1.0}, {5, 0x7, 1.0}, {6, 0x7, 2.0}, {7, 0x7, 1.0}}});
  return model;
}

FieldParameter parameter(const FiniteElementModel& model, const std::vector<Field>& fields, bool is_factor = false) {
  FieldParameter result{{}, is_factor};
  for (const auto& [card, id, name] : fields) {
    result.fields.push_back(field_of(model, card, id, name));
    EXPECT_NE(result.fields.back(), k_no_field) << card << ":" << id << ":" << name;
  }
  return result;
}

/// Random values between half and double of the deck's.
Eigen::VectorXd random_values(const FiniteElementModel& model, const std::vector<FieldParameter>& parameters,
                              std::mt19937_64& random) {
  std::uniform_real_distribution<double> factor(0.5, 2.0);
  Eigen::VectorXd x(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const double nominal = parameters[p].is_factor ? 1.0 : model.value(parameters[p].fields.front());
    x(static_cast<Eigen::Index>(p)) = nominal * factor(random);
  }
  return x;
}

/// Largest difference of K, M, C by terms from those of a new assembly, over a few random vectors.
double error_of_terms(const FiniteElementModel& model, const std::vector<FieldParameter>& parameters) {
  std::mt19937_64 random(1);
  const AssembledModel terms = assemble(model, parameters);
  const Eigen::VectorXd none;
  double largest = 0.0;
  for (int trial = 0; trial < 3; ++trial) {
    const Eigen::VectorXd x = random_values(model, parameters, random);
    const AssembledModel whole = assemble(moved(model, parameters, x), {});
    for (const auto member : {&AssembledModel::stiffness, &AssembledModel::mass, &AssembledModel::damping}) {
      largest = std::max(largest, scaled_difference(dense((whole.*member).at(none)), dense((terms.*member).at(x))));
    }
  }
  return largest;
}

// Both sum the same hundred or so numbers of each entry in another order: 1e-13 = 500 roundings.
constexpr double k_rounding = 1e-13;

class SeparableField : public testing::TestWithParam<Field> {};

TEST_P(SeparableField, GivesTheMatricesOfANewAssembly) {
  const FiniteElementModel model = mixed_model();
  for (const bool is_factor : {false, true}) {
    const std::vector<FieldParameter> parameters{parameter(model, {GetParam()}, is_factor)};
    EXPECT_TRUE(assemble(model, parameters).is_separable[0]);
    EXPECT_LT(error_of_terms(model, parameters), k_rounding) << (is_factor ? "factor" : "value");
  }
}

INSTANTIATE_TEST_SUITE_P(Fields, SeparableField,
                         testing::Values(Field{"MAT1", 1, "E"}, Field{"MAT1", 1, "RHO"}, Field{"MAT1", 2, "E"},
                                         Field{"MAT1", 2, "RHO"}, Field{"PSHELL", 3, "T"}, Field{"PBAR", 4, "A"},
                                         Field{"PBAR", 4, "I1"}, Field{"PBAR", 4, "I2"}, Field{"PBAR", 4, "J"},
                                         Field{"PBAR", 5, "J"}, Field{"PROD", 6, "A"}, Field{"CELAS2", 6, "K"},
                                         Field{"PDAMP", 7, "B"}, Field{"CMASS2", 8, "M"}, Field{"PBUSH", 9, "K1"},
                                         Field{"PBUSH", 9, "K5"}, Field{"PBUSH", 9, "B1"}, Field{"CONM2", 10, "M"},
                                         Field{"CONM2", 10, "I11"}, Field{"CONM2", 10, "I21"}));

/// Twelve parameters, some tied, some factors, several meeting in one element.
std::vector<FieldParameter> many_parameters(const FiniteElementModel& model) {
  return {parameter(model, {{"MAT1", 1, "E"}}),
          parameter(model, {{"MAT1", 2, "E"}}, true),
          parameter(model, {{"MAT1", 1, "RHO"}, {"MAT1", 2, "RHO"}}, true),
          parameter(model, {{"PSHELL", 3, "T"}}),
          parameter(model, {{"PBAR", 4, "A"}, {"PROD", 6, "A"}}),
          parameter(model, {{"PBAR", 4, "I1"}, {"PBAR", 4, "I2"}}),
          parameter(model, {{"PBAR", 4, "J"}, {"PBAR", 5, "J"}}, true),
          parameter(model, {{"CELAS2", 6, "K"}, {"PBUSH", 9, "K1"}, {"PBUSH", 9, "K6"}}, true),
          parameter(model, {{"CONM2", 10, "M"}, {"CMASS2", 8, "M"}}),
          parameter(model, {{"CONM2", 10, "I11"}}),
          parameter(model, {{"PDAMP", 7, "B"}, {"PBUSH", 9, "B1"}}, true)};
}

/// Smallest eigenvalue of a term against its diagonal.
double smallest_eigenvalue(const SparseMatrix& lower) {
  const Eigen::MatrixXd term = dense(lower);
  const Eigen::ArrayXd sizes = term.diagonal().array();
  const Eigen::VectorXd scales = (sizes > 0.0).select(sizes.abs().sqrt().inverse(), 1.0);
  const Eigen::MatrixXd scaled = scales.asDiagonal() * term * scales.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

/// What is claimed of terms holds; returns how many claims there are.
int sound_claims(const SparseMatrix& constant, const std::vector<SparseMatrix>& terms,
                 const std::vector<bool>& claims) {
  EXPECT_EQ(claims.size(), terms.size() + 1);
  int count = 0;
  for (std::size_t t = 0; t < claims.size(); ++t) {
    if (!claims[t]) continue;
    ++count;
    EXPECT_GT(smallest_eigenvalue(t == 0 ? constant : terms[t - 1]), -1e-12) << t;  // ten times what is tolerated
  }
  return count;
}

TEST(SeparableMatrix, EqualsANewAssemblyForManyParametersAtOnce) {
  const FiniteElementModel model = mixed_model();
  const std::vector<FieldParameter> parameters = many_parameters(model);
  EXPECT_LT(error_of_terms(model, parameters), k_rounding);
}

// One factor on E, T and RHO of the same shell: K has powers up to four.
TEST(SeparableMatrix, EqualsANewAssemblyForOneFactorOnSeveralNumbersOfAnElement) {
  const FiniteElementModel model = mixed_model();
  const std::vector<FieldParameter> parameters{
      parameter(model, {{"MAT1", 2, "E"}, {"PSHELL", 3, "T"}, {"PBAR", 4, "I1"}, {"MAT1", 2, "RHO"}}, true)};
  EXPECT_TRUE(assemble(model, parameters).is_separable[0]);
  EXPECT_LT(error_of_terms(model, parameters), k_rounding);
}

// All coefficients are polynomials of degree 4 at most in each parameter, for which the five-point difference is exact
// whatever its step; with a step of x/4 its rounding is below 1e-14.
TEST(SeparableMatrix, DerivativeIsTheFivePointDifference) {
  const FiniteElementModel model = mixed_model();
  std::vector<FieldParameter> parameters = many_parameters(model);
  const AssembledModel assembled = assemble(model, parameters);
  std::mt19937_64 random(2);
  const Eigen::VectorXd x = random_values(model, parameters, random);
  for (Eigen::Index p = 0; p < x.size(); ++p) {
    const double step = 0.25 * x(p);
    for (const SeparableMatrix* matrix : {&assembled.stiffness, &assembled.mass, &assembled.damping}) {
      const auto at = [&](double steps) {
        Eigen::VectorXd y = x;
        y(p) += steps * step;
        return dense(matrix->at(y));
      };
      const Eigen::MatrixXd difference = (at(-2) - 8.0 * at(-1) + 8.0 * at(1) - at(2)) / 12.0;
      const Eigen::MatrixXd derivative = step * dense(matrix->derivative(x, static_cast<int>(p)));
      const double scale = at(0).cwiseAbs().maxCoeff();
      EXPECT_LE((derivative - difference).cwiseAbs().maxCoeff(), 1e-13 * scale) << p;
    }
  }
}

class InseparableField : public testing::TestWithParam<Field> {};

// The claim is needed: the terms are off by far more than rounding.
TEST_P(InseparableField, IsSaidToBeSoAndIs) {
  FiniteElementModel model = mixed_model();
  test::ModelMaker maker{model};
  maker.model.elements<ShellElement>().push_back({.id = 20, .node_count = 3, .nodes = {1, 2, 5, 0}, .property = 1});
  maker.shell_property(21, 1, 0.3);
  maker.model.elements<ShellElement>().push_back({.id = 24, .nodes = {4, 5, 6, 7}, .property = 2});
  maker.shell_property(25, 1, 0.3);
  BeamProperty section = maker.model.beam_properties[0];
  section.id = 22;
  section.section = "BAR";
  section.dimensions = {maker.field("PBARL", 22, "DIM1", 0.1), maker.field("PBARL", 22, "DIM2", 0.2)};
  maker.model.beam_properties.push_back(section);
  maker.beam(23, 8, 10, 2);
  maker.model.beam_properties[0].inertia_12 = maker.field("PBAR", 4, "I12", 0.0);
  const std::vector<FieldParameter> parameters{parameter(maker.model, {GetParam()})};
  EXPECT_FALSE(assemble(maker.model, parameters).is_separable[0]);
  const bool is_zero = maker.model.value(parameters[0].fields[0]) == 0.0;  // no random factor moves it
  if (!is_zero) {
    EXPECT_GT(error_of_terms(maker.model, parameters), 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Fields, InseparableField,
                         testing::Values(Field{"MAT1", 1, "NU"}, Field{"MAT1", 2, "NU"}, Field{"PBAR", 5, "I1"},
                                         Field{"PBAR", 5, "A"}, Field{"PSHELL", 21, "T"}, Field{"PSHELL", 25, "T"},
                                         Field{"PBARL", 22, "DIM1"}, Field{"PBARL", 22, "DIM2"},
                                         Field{"PBAR", 4, "I12"}));

// E and G of one card determine Poisson's ratio; G and nu together scale everything alike.
TEST(SeparableMatrix, ASharedModulusIsSeparableWherePoissonsRatioStands) {
  FiniteElementModel model = mixed_model();
  model.fields.push_back({"MAT1", 2, "G", 2e11 / 2.56});
  const auto shear = static_cast<FieldIndex>(model.fields.size()) - 1;
  model.materials[1].shear = shear;
  model.elements<ShellElement>().push_back({.id = 20, .node_count = 3, .nodes = {1, 2, 5, 0}, .property = 0});
  FiniteElementModel by_ratio = model, by_moduli = model;
  by_ratio.materials[1].young = k_no_field;
  by_moduli.materials[1].poisson = k_no_field;
  const std::vector<FieldParameter> parameters{{{shear}, false}};
  EXPECT_TRUE(assemble(by_ratio, parameters).is_separable[0]);
  EXPECT_LT(error_of_terms(by_ratio, parameters), k_rounding);
  EXPECT_FALSE(assemble(by_moduli, parameters).is_separable[0]);
}

TEST(SeparableMatrix, TermsOfElementsAreKnownToBeSemidefiniteWhereTheyAre) {
  const FiniteElementModel model = mixed_model();
  const AssembledModel assembled = assemble(model, many_parameters(model));
  const PencilTerms terms = pencil_terms(assembled.stiffness, assembled.mass);
  // All stiffness is: solids, shells, beams, springs and bushes, also through rigid bodies and interpolations.
  EXPECT_EQ(sound_claims(terms.stiffness_constant, terms.stiffness, terms.is_stiffness_semidefinite),
            static_cast<int>(terms.stiffness.size()) + 1);
  EXPECT_GE(sound_claims(terms.mass_constant, terms.mass, terms.is_mass_semidefinite), 3);
}

TEST(SeparableMatrix, ATermWithANegativeSpringOrAProductOfInertiaIsNotKnownToBeSemidefinite) {
  FiniteElementModel model = mixed_model();
  const AssembledModel product = assemble(model, {parameter(model, {{"CONM2", 10, "I21"}})});
  const PencilTerms terms = pencil_terms(product.stiffness, product.mass);
  ASSERT_EQ(terms.mass.size(), 1U);
  EXPECT_LT(smallest_eigenvalue(terms.mass[0]), -0.1);
  EXPECT_FALSE(terms.is_mass_semidefinite[1]);
  // One of the springs of a term with many: its trace stays positive.
  const std::vector<FieldParameter> tied{parameter(model, {{"MAT1", 1, "E"}, {"CELAS2", 6, "K"}}, true)};
  EXPECT_TRUE(pencil_terms(assemble(model, tied).stiffness, {}).is_stiffness_semidefinite[1]);
  model.fields[static_cast<std::size_t>(field_of(model, "CELAS2", 6, "K"))].value = -1e6;
  EXPECT_FALSE(pencil_terms(assemble(model, tied).stiffness, {}).is_stiffness_semidefinite[1]);
}

}  // namespace
}  // namespace mottle::fem
