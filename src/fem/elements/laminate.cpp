#include "mottle/fem/elements/laminate.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <vector>

#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

/// A ply in the laminate's axes.
struct Layer {
  Eigen::Matrix3d elasticity;
  Eigen::Matrix2d shear_flexibility;
  double bottom = 0.0, top = 0.0;
};

Layer layer_of(const LaminatePly& ply, double bottom) {
  const double c = std::cos(ply.angle), s = std::sin(ply.angle);
  Eigen::Matrix3d strain;  // in ply axes from that in the laminate's
  strain << c * c, s * s, c * s, s * s, c * c, -c * s, -2.0 * c * s, 2.0 * c * s, c * c - s * s;
  const Eigen::Matrix2d turn{{c, s}, {-s, c}};
  return {strain.transpose() * ply.elasticity * strain, turn.transpose() * ply.shear_flexibility * turn, bottom,
          bottom + ply.thickness};
}

/// Neutral axis and bending stiffness along x (axis 0) or y (1), the other direction's curvature being zero.
struct Beam {
  double neutral = 0.0, stiffness = 0.0;
};

Beam beam_along(const std::vector<Layer>& layers, Eigen::Index axis) {
  double membrane = 0.0, first = 0.0, second = 0.0;
  for (const Layer& layer : layers) {
    const double modulus = layer.elasticity(axis, axis);
    membrane += modulus * (layer.top - layer.bottom);
    first += modulus * (std::pow(layer.top, 2) - std::pow(layer.bottom, 2)) / 2.0;
    second += modulus * (std::pow(layer.top, 3) - std::pow(layer.bottom, 3)) / 3.0;
  }
  if (membrane <= 0.0) return {};
  return {first / membrane, second - first * first / membrane};
}

/// S^-1 as in the header. The stresses are quadratic within a ply, so that three points integrate their products.
Eigen::Matrix2d shear_flexibility(const std::vector<Layer>& layers) {
  const std::array<Beam, 2> beams = {beam_along(layers, 0), beam_along(layers, 1)};
  constexpr std::array<double, 3> k_weights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const std::array<double, 3> places = {0.5 - 0.5 * std::sqrt(0.6), 0.5, 0.5 + 0.5 * std::sqrt(0.6)};
  Eigen::Matrix2d flexibility = Eigen::Matrix2d::Zero();
  Eigen::Vector2d below = Eigen::Vector2d::Zero();  // stress at the layer's bottom
  for (const Layer& layer : layers) {
    const double thickness = layer.top - layer.bottom;
    const auto stress_at = [&](double z) {
      Eigen::Vector2d stress = below;
      for (Eigen::Index axis = 0; axis < 2; ++axis) {
        const Beam& beam = beams[static_cast<std::size_t>(axis)];
        if (beam.stiffness <= 0.0) continue;
        // As a product: far from the neutral axis the difference of two squares would cancel.
        const double moment = (z - layer.bottom) * (beam.neutral - 0.5 * (z + layer.bottom));
        stress(axis) += layer.elasticity(axis, axis) * moment / beam.stiffness;
      }
      return stress;
    };
    for (std::size_t point = 0; point < 3; ++point) {
      const Eigen::DiagonalMatrix<double, 2> stress(stress_at(layer.bottom + places[point] * thickness));
      flexibility += k_weights[point] * thickness * (stress * layer.shear_flexibility * stress);
    }
    below = stress_at(layer.top);
  }
  return flexibility;
}

Eigen::Matrix2d shear_stiffness(const std::vector<Layer>& layers) {
  const Eigen::Matrix2d flexibility = shear_flexibility(layers);
  if (flexibility.isZero(0.0)) return Eigen::Matrix2d::Zero();
  require(flexibility.determinant() > 1e-12 * std::pow(flexibility.norm(), 2),
          "the laminate is rigid in transverse shear in one direction only; give G1Z and G2Z of its plies, or neither");
  return flexibility.inverse();
}

}  // namespace

Eigen::Matrix3d orthotropic_plane_stress(double young_1, double young_2, double poisson_12, double shear_12) {
  require(young_1 > 0.0 && young_2 > 0.0, "E1 is {:g} and E2 is {:g}, both must be positive", young_1, young_2);
  require(shear_12 >= 0.0, "G12 is {:g}, a number >= 0 is needed", shear_12);
  const double remainder = 1.0 - poisson_12 * poisson_12 * young_2 / young_1;
  require(remainder > 0.0, "NU12 is {:g}, with E1 / E2 = {:g} it must lie within +-{:g}", poisson_12, young_1 / young_2,
          std::sqrt(young_1 / young_2));
  Eigen::Matrix3d elasticity = Eigen::Matrix3d::Zero();
  elasticity(0, 0) = young_1 / remainder;
  elasticity(1, 1) = young_2 / remainder;
  elasticity(0, 1) = elasticity(1, 0) = poisson_12 * young_2 / remainder;
  elasticity(2, 2) = shear_12;
  return elasticity;
}

ShellSection laminate_section(std::span<const LaminatePly> plies, double bottom) {
  require(!plies.empty(), "the laminate has no ply");
  std::vector<Layer> layers;
  double z = bottom;
  for (const LaminatePly& ply : plies) {
    require(ply.thickness > 0.0, "ply {} has a thickness of {:g}, it must be positive", layers.size() + 1,
            ply.thickness);
    layers.push_back(layer_of(ply, z));
    z = layers.back().top;
  }
  ShellSection section;
  for (const Layer& layer : layers) {
    // Thickness, mean and central moment instead of powers of z: B of a symmetric laminate is zero but for rounding.
    const double thickness = layer.top - layer.bottom, middle = 0.5 * (layer.top + layer.bottom);
    section.membrane += thickness * layer.elasticity;
    section.coupling += thickness * middle * layer.elasticity;
    section.bending += thickness * (middle * middle + thickness * thickness / 12.0) * layer.elasticity;
  }
  // Below this B is what rounding leaves of a symmetric laminate.
  if (section.coupling.norm() < 1e-14 * section.membrane.norm() * (z - bottom)) section.coupling.setZero();
  section.shear = shear_stiffness(layers);
  return section;
}

}  // namespace mottle::fem
