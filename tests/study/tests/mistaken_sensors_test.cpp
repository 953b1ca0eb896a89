// Sensors that are exchanged or upside down in all shapes of a table.
#include "study/tests/mistaken_sensors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace mottle::study {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const OutputSelection k_outputs{
    .frequencies = {1, 2, 3}, .shape_modes = {1, 2, 3}, .shape_degrees_of_freedom = {"a", "b", "c", "d", "e"}};

Eigen::MatrixXd reference() {
  Eigen::MatrixXd shapes(5, 3);
  for (Eigen::Index k = 0; k < 5; ++k) {
    for (Eigen::Index m = 0; m < 3; ++m) shapes(k, m) = std::sin(0.5 * static_cast<double>((k + 1) * (m + 1)));
  }
  return shapes;
}

/// Six specimens whose components differ from the reference's by some 3 %.
Eigen::MatrixXd specimens() {
  std::mt19937 generator(7);
  std::normal_distribution<double> scatter(0.0, 0.03);
  Eigen::MatrixXd values(6, 18);
  for (Eigen::Index s = 0; s < 6; ++s) {
    values.row(s).head(3) << 10.0, 20.0, 30.0;
    values.row(s).tail(15) = reference().reshaped().transpose();
    for (Eigen::Index k = 3; k < 18; ++k) values(s, k) += scatter(generator);
  }
  return values;
}

TEST(MistakenSensors, AreNoneWhereShapesScatter) {
  EXPECT_THAT(mistaken_sensors(specimens(), k_outputs, reference()), IsEmpty());
}

TEST(MistakenSensors, AreTheTwoThatWereExchanged) {
  Eigen::MatrixXd values = specimens();
  for (Eigen::Index m = 0; m < 3; ++m) values.col(3 + 5 * m + 1).swap(values.col(3 + 5 * m + 3));
  values(2, 3 + 5 + 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(mistaken_sensors(values, k_outputs, reference()),
              HasSubstr("if sensors b and d are exchanged (mean MAC"));
}

TEST(MistakenSensors, AreTheOneThatIsUpsideDown) {
  Eigen::MatrixXd values = specimens();
  for (Eigen::Index m = 0; m < 3; ++m) values.col(3 + 5 * m + 2) *= -1.0;
  EXPECT_THAT(mistaken_sensors(values, k_outputs, reference()), HasSubstr("if the sign of sensor c is reversed"));
}

TEST(MistakenSensors, AreNotSoughtInOneModeAlone) {
  const OutputSelection one{
      .frequencies = {1}, .shape_modes = {2}, .shape_degrees_of_freedom = k_outputs.shape_degrees_of_freedom};
  Eigen::MatrixXd values = specimens()(Eigen::all, std::vector<Eigen::Index>{0, 8, 9, 10, 11, 12});
  values.col(1) *= -1.0;
  EXPECT_THAT(mistaken_sensors(values, one, reference().col(1)), IsEmpty());
}

TEST(MistakenSensors, AreNoneWhereTheModelIsWrongOtherwise) {
  Eigen::MatrixXd values = specimens();
  for (Eigen::Index m = 0; m < 3; ++m) values.col(3 + 5 * m).array() += 0.8;  // a support that moves
  EXPECT_THAT(mistaken_sensors(values, k_outputs, reference()), IsEmpty());
}

TEST(MistakenSensors, AreFoundAmongHundreds) {
  constexpr Eigen::Index k_count = 300;
  Eigen::MatrixXd model(k_count, 3);
  for (Eigen::Index k = 0; k < k_count; ++k) {
    for (Eigen::Index m = 0; m < 3; ++m)
      model(k, m) = 0.05 * std::sin(0.02 * static_cast<double>((k + 1) * (m + 1))) + (k == 17 ? 1.0 : 0.0);
  }
  OutputSelection outputs{.shape_modes = {1, 2, 3}};
  for (Eigen::Index k = 0; k < k_count; ++k) outputs.shape_degrees_of_freedom.push_back("n" + std::to_string(k));
  Eigen::MatrixXd values = model.reshaped().transpose();
  for (Eigen::Index m = 0; m < 3; ++m) values.col(m * k_count + 17).swap(values.col(m * k_count + 230));
  EXPECT_THAT(mistaken_sensors(values, outputs, model), HasSubstr("if sensors n17 and n230 are exchanged"));
}

}  // namespace
}  // namespace mottle::study
