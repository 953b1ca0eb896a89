// Parameter-separable matrices K(x) = K0 + sum_i x_i K_i, M(x) and C(x) likewise, kept as their terms.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/fem/assembly/mass_spring.hpp"

namespace mottle {

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

/// What one parameter acts on.
struct ParameterTargets {
  std::string parameter;             ///< its name, for messages
  std::vector<std::string> targets;  ///< "spring:k1", "mass:m1", "damper:c1"
  bool is_factor = false;            ///< the value multiplies the nominal value instead of replacing it
};

/// The structure of a mass-spring system whose elements named by `parameters` follow the parameters.
///
/// Throws InvalidInput: unknown kind of target or unknown element (with the nearest known one), an element tied to
/// two parameters, a factor on an element whose nominal value is zero (the parameter would act on nothing).
AffineStructure separate(const MassSpringSystem& system, const std::vector<ParameterTargets>& parameters);

/// Whether a parameter is a stiffness or mass (must be > 0), or damping alone (must be >= 0).
struct PhysicalLimit {
  double lower = 0.0;
  bool excludes_lower = true;
};

/// The physically possible values of one parameter.
PhysicalLimit physical_limit(const ParameterTargets& parameter);

}  // namespace mottle
