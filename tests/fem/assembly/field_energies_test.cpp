// Energies of modes by card field against sums by hand, and their derivatives against frequencies solved anew.
#include "mottle/fem/assembly/field_energies.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "fem/models.hpp"

namespace mottle::fem {
namespace {

struct Modes {
  Eigen::VectorXd values;
  Eigen::MatrixXd displacements;  ///< [6 node + component x mode]
};

/// The lowest modes, ascending, by Eigen's dense solver: M phi = (1 / lambda) K phi, since M is singular where
/// rotations have no mass.
Modes solve(const FiniteElementModel& model, Eigen::Index count) {
  const AssembledModel assembled = assemble(model, {});
  const Eigen::VectorXd none;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(test::dense(assembled.mass.at(none)),
                                                                         test::dense(assembled.stiffness.at(none)));
  const Eigen::MatrixXd vectors = solver.eigenvectors().rightCols(count).rowwise().reverse();
  return {solver.eigenvalues().tail(count).reverse().cwiseInverse(), assembled.expansion * vectors};
}

// Ground - k1 - m1 - k2 - m2 with k = 1, m = 1: lambda = (3 -+ sqrt 5) / 2, phi2 / phi1 = (1 +- sqrt 5) / 2, so that
// the first spring has phi1^2 / (phi1^2 + (phi2 - phi1)^2) of the strain energy.
TEST(FieldEnergies, FollowTheElongationsOfTwoSprings) {
  test::ModelMaker maker;
  maker.scalar_point(1);
  maker.scalar_point(2);
  maker.spring(1, 0, 0, -1, 0, 1.0);
  maker.spring(2, 0, 0, 1, 0, 1.0);
  maker.mass(3, 0, 0, 1.0);
  maker.mass(4, 1, 0, 1.0);
  const Modes modes = solve(maker.model, 2);
  const FieldEnergies energies = field_energies(maker.model, modes.displacements);
  for (Eigen::Index mode = 0; mode < 2; ++mode) {
    const double ratio = (1.0 + (mode == 0 ? 1.0 : -1.0) * std::sqrt(5.0)) / 2.0;
    const double elongation = (ratio - 1.0) * (ratio - 1.0);
    EXPECT_NEAR(energies.strain(0, mode) / energies.total_strain(mode), 1.0 / (1.0 + elongation), 1e-13);
    EXPECT_NEAR(energies.kinetic(3, mode) / energies.total_kinetic(mode), ratio * ratio / (1.0 + ratio * ratio), 1e-13);
    EXPECT_NEAR(energies.total_strain(mode) / energies.total_kinetic(mode), modes.values(mode), 1e-13);
    EXPECT_DOUBLE_EQ(energies.strain_derivative(0, mode), energies.strain(0, mode));
  }
  EXPECT_EQ(energies.elements.sum(), 4);
  EXPECT_EQ(energies.kinetic(0, 0), 0.0);
}

/// A stiffened plate, held along one side, in displacement axes of its own, with a mass on a rigid arm.
test::ModelMaker stiffened_plate() {
  test::ModelMaker maker;
  CoordinateSystem system{.id = 1};
  system.axes = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  maker.model.coordinate_systems.push_back(system);
  const int metal = maker.material(1, 7e10, 0.33, 2700.0);
  const int skin = maker.shell_property(1, metal, 0.004);
  const int stringer = maker.beam_property(2, metal, 1e-4, 2e-9, 5e-9, 3e-9);
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 4; ++i) maker.node(4 * j + i + 1, {0.1 * i, 0.1 * j, 0.0}, j == 1 ? 0 : -1);
  }
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 3; ++i) {
      const int a = 4 * j + i;
      maker.model.elements<ShellElement>().push_back(
          {.id = a + 1, .nodes = {a, a + 1, a + 5, a + 4}, .property = skin});
    }
  }
  for (int i = 0; i < 3; ++i) maker.beam(20 + i, 4 + i, 5 + i, stringer, Eigen::Vector3d::UnitZ());
  const int arm = maker.node(30, {0.35, 0.1, 0.08});
  maker.point_mass(31, arm, 0.1);
  maker.model.rigid_bodies.push_back({.id = 32, .independent = 7, .components = k_all_components, .dependents = {arm}});
  for (const int held : {0, 4, 8}) maker.model.fixed.emplace_back(held, k_all_components);
  return maker;
}

// lambda(p) by two models solved anew, p moved by one in ten thousand; its error is (h^2 = 1e-8) times the third
// derivative, some hundred where two modes are near each other.
TEST(FieldEnergies, DerivativesAreThoseOfFrequenciesSolvedAnew) {
  constexpr double k_step = 1e-4;
  constexpr Eigen::Index k_modes = 5;
  FiniteElementModel model = stiffened_plate().model;
  const Modes modes = solve(model, k_modes);
  const FieldEnergies energies = field_energies(model, modes.displacements);
  for (std::size_t field = 0; field < model.fields.size(); ++field) {
    const double value = model.fields[field].value;
    model.fields[field].value = (1.0 + k_step) * value;
    const Eigen::VectorXd above = solve(model, k_modes).values.array().log();
    model.fields[field].value = (1.0 - k_step) * value;
    const Eigen::VectorXd below = solve(model, k_modes).values.array().log();
    model.fields[field].value = value;
    for (Eigen::Index mode = 0; mode < k_modes; ++mode) {
      const auto row = static_cast<Eigen::Index>(field);
      const double found = energies.strain_derivative(row, mode) / energies.total_strain(mode) -
                           energies.kinetic_derivative(row, mode) / energies.total_kinetic(mode);
      EXPECT_NEAR(found, (above(mode) - below(mode)) / (2.0 * k_step), 1e-6)
          << model.fields[field].card << ' ' << model.fields[field].name << " mode " << mode + 1;
    }
  }
}

TEST(FieldEnergies, SumToTheEigenvaluesForAWholeModel) {
  const FiniteElementModel model = stiffened_plate().model;
  const Modes modes = solve(model, 6);
  const FieldEnergies energies = field_energies(model, modes.displacements);
  const Eigen::RowVectorXd quotients = energies.total_strain.array() / energies.total_kinetic.array();
  EXPECT_TRUE(quotients.isApprox(modes.values.transpose(), 1e-9));
  EXPECT_EQ(energies.elements(0), 9) << "Young's modulus: six shells and three beams";
}

}  // namespace
}  // namespace mottle::fem
