// Parameter-separable matrices K(x) = K0 + sum_i x_i K_i, M(x) and C(x) likewise, kept as their terms.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/fem/assembly/mass_spring.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/parameters/parameter_targets.hpp"

namespace mottle::model {

/// A matrix that depends on the parameters through known terms (Eq. 2 of [Mares2006] with g_i(x) = x_i).
struct AffineMatrix {
  struct Term {
    Eigen::Index parameter = 0;
    Eigen::MatrixXd matrix;
  };

  Eigen::MatrixXd constant;
  std::vector<Term> terms;

  /// The matrix at `parameters` [parameter].
  Eigen::MatrixXd at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// Its derivative with respect to one parameter.
  Eigen::MatrixXd derivative(Eigen::Index parameter) const;
};

/// Stiffness, mass and damping of one structure.
struct AffineStructure {
  AffineMatrix stiffness;
  AffineMatrix mass;
  AffineMatrix damping;
  std::vector<std::string> degree_of_freedom_names;
};

/// The structure of a mass-spring system whose elements named by `parameters` follow the parameters.
///
/// Throws InvalidInput: unknown kind of target or unknown element (with the nearest known one), an element tied to
/// two parameters, a factor on an element whose nominal value is zero (the parameter would act on nothing).
AffineStructure separate(const MassSpringSystem& system, const std::vector<ParameterTargets>& parameters);

}  // namespace mottle::model
