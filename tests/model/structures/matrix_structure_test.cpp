#include "mottle/model/structures/matrix_structure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"
#include "mottle/model/solvers/exact_solver.hpp"

namespace mottle::model {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

SymmetricMatrix symmetric(const Eigen::MatrixXd& full, std::vector<std::string> names = {}) {
  SymmetricMatrix matrix;
  matrix.lower = Eigen::MatrixXd(full.triangularView<Eigen::Lower>()).sparseView();
  matrix.names = std::move(names);
  return matrix;
}

/// A mass between two springs, and one on its other side: K = k1 [1 0; 0 0] + k2 [1 -1; -1 1].
MatrixSystem two_masses() {
  MatrixSystem system;
  system.mass = symmetric(Eigen::Matrix2d::Identity(), {"1:+X", "2:+X"});
  system.parts.push_back({"wall", symmetric(Eigen::Matrix2d{{3.0, 0.0}, {0.0, 0.0}}, {"1:+X", "2:+X"}), {}, 3.0, 1});
  system.parts.push_back({"link", symmetric(Eigen::Matrix2d{{8.0, -8.0}, {-8.0, 8.0}}, {"1:+X", "2:+X"}), {}, 2.0, 3});
  return system;
}

const std::vector<ParameterTargets> k_both = {{"k1", {"K:wall"}}, {"h", {"K:link"}}};

TEST(MatrixStructure, ScalesPartsByPowersOfTheirNominalValues) {
  const MatrixModel model = bind_parameters(two_masses(), k_both, Eigen::Vector2d(1.0, 1.0));
  EXPECT_EQ(model.reference, Eigen::Vector2d(3.0, 2.0));
  // 3 becomes 6 by k1 = 6; 8 becomes 27 by h = 3: (3 / 2)^3.
  const Eigen::MatrixXd k = model.pencil.stiffness.at(Eigen::Vector2d(6.0, 3.0));
  EXPECT_TRUE(k.isApprox(Eigen::Matrix2d{{33.0, 0.0}, {-27.0, 27.0}}, 1e-15));
}

TEST(MatrixStructure, HasTheModesOfTheClosedForm) {
  MatrixModel model = bind_parameters(two_masses(), k_both, Eigen::Vector2d(1.0, 1.0));
  const ExactSolver solver(std::make_unique<MatrixStructure>(std::move(model.pencil), model.reference));
  // K = [2 -1; -1 1]: (3 -+ sqrt 5) / 2.
  const ModeSet modes = solver.modes_at(Eigen::Vector2d(1.0, 1.0), 2);
  EXPECT_NEAR(modes.eigenvalues(0), 0.5 * (3.0 - std::sqrt(5.0)), 1e-12);
  EXPECT_NEAR(modes.eigenvalues(1), 0.5 * (3.0 + std::sqrt(5.0)), 1e-12);
  EXPECT_EQ(solver.structure().total_mass(Eigen::Vector2d(1.0, 1.0)), 2.0);
  EXPECT_EQ(solver.structure().find_degree_of_freedom("2:+X"), 1);
  EXPECT_THAT(solver.structure().unknown_degree_of_freedom("2:+Y"), HasSubstr("did you mean '2:+X'?"));
}

TEST(MatrixStructure, PutsMatricesOfOtherRowsTogetherByNames) {
  MatrixSystem system = two_masses();
  system.parts[0].stiffness = symmetric(Eigen::MatrixXd::Constant(1, 1, 3.0), {"1:+X"});
  system.parts[1].stiffness = symmetric(Eigen::Matrix2d{{8.0, -8.0}, {-8.0, 8.0}}, {"2:+X", "1:+X"});
  const MatrixModel model = bind_parameters(system, k_both, Eigen::Vector2d(1.0, 1.0));
  EXPECT_THAT(model.pencil.names, ElementsAre("1:+X", "2:+X"));
  const Eigen::MatrixXd k = model.pencil.stiffness.at(model.reference);
  EXPECT_TRUE(k.isApprox(Eigen::Matrix2d{{11.0, 0.0}, {-8.0, 8.0}}, 1e-15));
}

TEST(MatrixStructure, LeavesOutRowsThatTheSolverHeld) {
  MatrixSystem system = two_masses();
  system.parts[1].stiffness->fixed_rows = {1};
  const MatrixModel model = bind_parameters(system, k_both, Eigen::Vector2d(1.0, 1.0));
  EXPECT_THAT(model.pencil.names, ElementsAre("1:+X"));
  EXPECT_EQ(Eigen::MatrixXd(model.pencil.stiffness.at(model.reference)), Eigen::MatrixXd::Constant(1, 1, 11.0));
}

TEST(MatrixStructure, FindsRigidBodyModesOfAFreeStructureAndNoModesOfMasslessRows) {
  MatrixSystem system;
  Eigen::Matrix3d k;
  k << 1, -1, 0, -1, 2, -1, 0, -1, 1;
  system.parts.push_back({"chain", symmetric(k), {}, {}, 1});
  system.mass = symmetric(Eigen::Vector3d(1.0, 0.0, 1.0).asDiagonal());
  MatrixModel model = bind_parameters(system, {{"k", {"K:chain"}}}, Eigen::VectorXd::Ones(1));
  const ExactSolver solver(std::make_unique<MatrixStructure>(std::move(model.pencil), model.reference));
  const ModeSet modes = solver.modes_at(Eigen::VectorXd::Ones(1), 3);
  ASSERT_EQ(modes.eigenvalues.size(), 2);
  EXPECT_NEAR(modes.eigenvalues(0), 0.0, 1e-12);
  EXPECT_NEAR(modes.eigenvalues(1), 1.0, 1e-12);  // the ends against each other, half of the chain's k / 2 each
}

TEST(MatrixStructure, SaysWhichRowHasNeitherStiffnessNorMass) {
  MatrixSystem system;
  system.stiffness = symmetric(Eigen::Vector2d(1.0, 0.0).asDiagonal(), {"1:+X", "9:+Z"});
  system.mass = symmetric(Eigen::Vector2d(1.0, 0.0).asDiagonal(), {"1:+X", "9:+Z"});
  MatrixModel model = bind_parameters(system, {}, Eigen::VectorXd());
  const ExactSolver solver(std::make_unique<MatrixStructure>(std::move(model.pencil), model.reference));
  EXPECT_THAT(test::message_of<InvalidInput>([&] { solver.modes_at(Eigen::VectorXd(), 1); }),
              HasSubstr("first seen at 9:+Z"));
}

TEST(MatrixStructure, RefusesAMassMatrixThatGivesNoLength) {
  MatrixSystem system;
  system.stiffness = symmetric(Eigen::Vector2d(2.0, 1.0).asDiagonal());
  system.mass = symmetric(Eigen::Vector2d(1.0, -1.0).asDiagonal());
  MatrixModel model = bind_parameters(system, {}, Eigen::VectorXd());
  const ExactSolver solver(std::make_unique<MatrixStructure>(std::move(model.pencil), model.reference));
  EXPECT_THAT(test::message_of<InvalidInput>([&] { solver.modes_at(Eigen::VectorXd(), 2); }),
              HasSubstr("not positive semidefinite: the diagonal entry of row 2 is -1"));
}

TEST(MatrixStructure, RefusesWhatCannotBeBound) {
  const Eigen::Vector2d ones(1.0, 1.0);
  const auto message = [&](const MatrixSystem& system, const std::vector<ParameterTargets>& parameters) {
    return test::message_of<InvalidInput>([&] { bind_parameters(system, parameters, ones); });
  };
  EXPECT_THAT(message(two_masses(), {{"k1", {"K:wal"}}}), HasSubstr("did you mean 'K:wall'?"));
  EXPECT_THAT(message(two_masses(), {{"k1", {"K:wall"}}, {"k2", {"K:wall"}}}),
              HasSubstr("already tied to parameter 'k1'"));
  MatrixSystem unnamed = two_masses();
  unnamed.mass = symmetric(Eigen::Matrix3d::Identity());
  EXPECT_THAT(message(unnamed, k_both), HasSubstr("without names"));
  MatrixSystem massless = two_masses();
  massless.mass.reset();
  EXPECT_THAT(message(massless, k_both), HasSubstr("there is no mass matrix"));
}

}  // namespace
}  // namespace mottle::model
