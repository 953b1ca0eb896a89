// Eigenvalues against closed forms and against the frequencies that they stand for.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "model/structures.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"

namespace mottle::model {
namespace {

using test::one_each;

// One mass: lambda = k / m, d lambda / dk = 1 / m, d lambda / dm = -k / m^2.
TEST(Eigenvalues, HaveTheClosedFormOfOneMass) {
  const MassSpringSystem system{.masses = {{"m", 1.0}}, .springs = {{"k", k_ground, 0, 1.0}}, .dampers = {}};
  const StructureModel model(separate(system, one_each({"spring:k", "mass:m"})), {.eigenvalues = {1}},
                             Eigen::Vector2d::Ones());
  const Eigen::Vector2d x(9.0, 4.0);
  EXPECT_NEAR(model.evaluate(x.transpose(), {}).outputs(0), 2.25, 1e-14);
  const Eigen::MatrixXd jacobian = model.jacobian(x);
  EXPECT_NEAR(jacobian(0, 0), 0.25, 1e-14);
  EXPECT_NEAR(jacobian(0, 1), -0.5625, 1e-14);
}

TEST(Eigenvalues, AreSquaresOfTheAngularFrequencies) {
  const StructureModel model(separate(test::three_mass_system(), one_each({"spring:k1", "mass:m2"})),
                             {.frequencies = {1, 2, 3}, .eigenvalues = {3, 1}, .units = unit_names("mm-kg-ms")},
                             Eigen::Vector2d::Ones());
  EXPECT_EQ(model.outputs()[3].name(), "lambda3");
  EXPECT_EQ(model.outputs()[3].unit, "(rad/ms)^2");
  const Eigen::Vector2d x(1.3, 0.8);
  const Eigen::RowVectorXd y = model.evaluate(x.transpose(), {}).outputs.row(0);
  const Eigen::MatrixXd jacobian = model.jacobian(x);
  for (const auto& [eigenvalue, frequency] : {std::pair{3, 2}, std::pair{4, 0}}) {
    const double square = std::pow(2.0 * std::numbers::pi, 2);
    EXPECT_NEAR(y(eigenvalue), square * y(frequency) * y(frequency), 1e-12 * y(eigenvalue));
    // d lambda = 8 pi^2 f df
    const Eigen::RowVectorXd expected = 2.0 * square * y(frequency) * jacobian.row(frequency);
    EXPECT_LT((jacobian.row(eigenvalue) - expected).cwiseAbs().maxCoeff(), 1e-12);
  }
}

}  // namespace
}  // namespace mottle::model
